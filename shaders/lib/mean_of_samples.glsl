#pragma once
// The mean of a pixel's samples: the unbiased estimate of its radiance under a box filter. Each by its
// share, which for a power of two is exact: the sum of bright samples may be no float where their mean is.
vec4 mean_of_samples(uint image, ivec2 p, int samples) {
  precise vec4 sum = vec4(0.0);
  for (int s = 0; s < samples; ++s)
    sum += texelFetch(pass_multisampled_images[image], p, s) * (1.0 / float(samples));
  return sum;
}
