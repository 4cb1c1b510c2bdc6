#pragma once
// What rays to lights have found (passes/shadows/light_rays.h). Needs RECORDS_AT, their address, and lib/frame.glsl.
//
// First RaySettings, how rays are sent, and the words of a room; then a word for each pixel: where its records are; 0:
// there was no room for them. Then a room for each workgroup of 8 by 8 pixels, of which each of its subgroups has an
// even part. A record is of one light and all lanes: the light's number, how many words follow, and for each ray a bit
// a lane or, where something lets a part of the light through, a float a lane. Lights ascend; behind the last comes
// no_record. Records of the second triangle of each pixel follow, and so on.
const uint no_record = 0xffffffffu, record_head = 2u;
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer RecordsRef { uint w[]; };

uvec2 record_groups() { return (frame.size_px + 7u) / 8u; }
const uint record_room_word = 7u;
RecordsRef all_records() { return RecordsRef(RECORDS_AT); }
uint64_t record_room(uvec2 pixel, uint room) {
  const uvec2 groups = record_groups();
  return RECORDS_AT + 256ul * (1ul + uint64_t(groups.x) * uint64_t(groups.y)) +
      4ul * uint64_t(room) * (uint64_t(pixel.y / 8u) * uint64_t(groups.x) + uint64_t(pixel.x / 8u));
}
RecordsRef record_place(uvec2 pixel) {
  const uvec2 group = pixel / 8u, in_group = pixel % 8u;
  return RecordsRef(RECORDS_AT + 256ul + 256ul * (uint64_t(group.y) * uint64_t(record_groups().x) + uint64_t(group.x)) +
      4ul * uint64_t(in_group.x + 8u * in_group.y));
}
uint record_words(uint width) { return RAYS_MEET_BLENDED != 0 ? width : (width + 31u) / 32u; }  // of one ray

#ifdef LIGHT_RECORDS
RecordsRef records;  // of the pixel's subgroup
uint record_at, record_lane, record_width;

// Of the pixel's first triangle. False: there was no room.
bool begin_records(uvec2 pixel) {
  const uint place = record_place(pixel).w[0];
  record_lane = place & 255u;
  record_width = place >> 16u & 255u;
  const uint subgroup = place >> 8u & 255u, subgroups = 64u / max(record_width, 1u);
  const uint room = all_records().w[record_room_word];
  records = RecordsRef(record_room(pixel, room) + 4ul * uint64_t(subgroup * (room / subgroups)));
  record_at = 0u;
  return place != 0u;
}
// Of its next one.
void next_records() {
  while (records.w[record_at] != no_record) record_at += record_head + records.w[record_at + 1u];
  ++record_at;
}
// Asked in ascending order. False: no ray was sent to the light.
bool find_record(uint light) {
  uint found = records.w[record_at];
  while (found < light) {
    record_at += record_head + records.w[record_at + 1u];
    found = records.w[record_at];
  }
  return found == light;
}
// Of the light that was found: what comes along its ray number i.
float record_seen(uint i) {
  const uint words = record_at + record_head + i * record_words(record_width);
  if (RAYS_MEET_BLENDED != 0) return uintBitsToFloat(records.w[words + record_lane]);
  return float(records.w[words + record_lane / 32u] >> (record_lane & 31u) & 1u);
}
#endif
