#pragma once
#include <stddef.h>
#include <stdint.h>

// The C interface of candela_demoscenes.so, which makes the scenes that are made for a picture (src/demoscenes). It is
// opened at first need.
extern "C" {

enum CandelaDemoScenePart {
  candela_demo_scene_glb,
  candela_demo_scene_sky,
  candela_demo_scene_night_sky,
  candela_demo_scene_look,
  candela_demo_scene_texts,
  candela_demo_scene_sound
};

// Takes the whole file. Returns 0, or another number when there is no memory for it.
typedef int CandelaDemoSceneSink(void* user, const void* bytes, size_t size);

// The .glb of a scene, its skies, Radiance HDRs, its sound, a WAV, or its look, in which SCENE stands for the name of
// the scene's file without its end, or the texts that the look names, a JSON object of what follows that name and what
// stands in them; a scene without them gives the sink nothing. lights: 0 is the scene's own number. Null when all went
// well, else one line that says what is wrong; it stays valid until the thread's next call.
typedef const char* CandelaMakeDemoScene(const char* name, CandelaDemoScenePart part, uint64_t seed, int lights,
                                         CandelaDemoSceneSink* sink, void* user);
}
