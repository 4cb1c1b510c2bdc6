#version 460
layout(local_size_x_id = 3, local_size_y = 2, local_size_z_id = 4) in;
void main() {}
