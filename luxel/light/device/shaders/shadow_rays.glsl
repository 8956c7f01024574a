// Shadow rays of a place and what they are worth: luxel/light/shadow_rays.h.

// light::Source
struct Source {
  bool exact, drawn;
  uint planned, rays;
  float scale;
  float sum_weight, second_weight;
  vec3 sum, tint;
  float sum_luminance2, second_luminance;
  float unshadowed;
};
Source new_source(float scale, uint planned) {
  return Source(false, false, planned, 0, scale, 0, 0, vec3(0), vec3(1), 0, 0, 0);
}

// What is known of a place's light: the sum over its sources, and the differences between drawn
// ones that follow each other.
struct Sum {
  LightAt light;
  float before, squares;
  uint drawn;
};

// Traces a shadow ray at a source, and adds what it brings. One that points below the place's own
// triangle is blocked by it.
void add_shadow_ray(inout Source s, inout Sum sum, Receiver r, float weight, vec3 radiance, vec3 direction,
                    float t_max) {
  s.sum_weight += weight;
  bool second_half = 2 * s.rays >= s.planned;
  if (second_half) s.second_weight += weight;
  ++s.rays;
  if (dot(direction, r.geometric_normal) <= 0) return;
  ++sum.light.rays;
  if (trace(setup.world, Ray(r.position, direction, 0, t_max), true).number != kNoTriangle) return;
  s.sum += radiance;
  float l = luminance(radiance);
  s.sum_luminance2 += l * l;
  if (second_half) s.second_luminance += l;
}

float variance_of(Source s, float light) {
  float n = float(s.rays);
  if (s.exact) {
    float share = min(1.0, light / max(s.unshadowed, 1e-30));
    return s.unshadowed * s.unshadowed * share * (1 - share) / n;
  }
  float mean = luminance(s.sum) / n, mean2 = s.sum_luminance2 / n;
  return max(0.0, mean2 - mean * mean) * s.scale * s.scale * n;
}

float split_variance_of(Source s, float light, float whole) {
  float sum = luminance(s.sum), first_weight = s.sum_weight - s.second_weight;
  if (!(first_weight > 0) || !(s.second_weight > 0) || !(sum > 0)) return whole;
  float a = s.exact ? (sum - s.second_luminance) / first_weight * s.sum_weight : 2 * (sum - s.second_luminance);
  float b = s.exact ? s.second_luminance / s.second_weight * s.sum_weight : 2 * s.second_luminance;
  float half_difference = 0.5 * (a - b) / sum * light;
  return half_difference * half_difference;
}

void add_source(Source s, inout Sum sum) {
  if (s.drawn) {
    float l = luminance(s.sum * s.tint) * s.scale, d = l - sum.before;
    if (sum.drawn > 0) sum.squares += 0.5 * d * d;
    sum.before = l, ++sum.drawn;
  }
  if (s.rays == 0 || s.sum_weight <= 0) return;
  vec3 light = s.sum * s.tint * (s.exact ? s.scale / s.sum_weight : s.scale);
  sum.light.irradiance += light;
  if (s.drawn) return;
  float variance = variance_of(s, luminance(light));
  sum.light.variance += variance;
  sum.light.split_variance += split_variance_of(s, luminance(light), variance);
}

// Variance of what was drawn, by the differences between neighbours [Wolter85, eq. 7.2.4].
float drawn_variance(Sum sum) {
  if (sum.drawn < 2) return sum.before * sum.before;
  return sum.squares * float(sum.drawn) / float(sum.drawn - 1);
}
