// Colours for the values of light; `look` says which.

vec3 linear(vec3 c) {
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, vec3(lessThanEqual(c, vec3(0.04045))));
}

vec3 false_color(float value) {
  float t = (value - look.low) / (look.high - look.low);
  if (look.is_logarithmic != 0)
    t = value > look.low ? log(value / look.low) / log(look.high / look.low) : 0;
  return linear(unpackUnorm4x8(look.colors[uint(clamp(t, 0, 1) * 255 + 0.5)]).rgb);
}

float value_of(vec3 e) {
  if (look.channel == 3) return dot(e, vec3(0.2126, 0.7152, 0.0722));
  return e[look.channel];
}
