#pragma once
// Outputs of shaders that divide beauty: attachments of their own, or, with STORED, a variable, which put_out() stores.
#ifdef STORED
#include "lib/stored_fragments.glsl"
#define TERM_OUTPUT(attachment)
#else
#define TERM_OUTPUT(attachment) layout(location = attachment) out
bool is_put_out() { return true; }
#endif
