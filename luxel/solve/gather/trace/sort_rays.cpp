#include "luxel/solve/gather/trace/sort_rays.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/random.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"

namespace luxel::gather {
namespace {

/// Counts `rays` rays of an element that end alike.
void count_ends(RayEnd end, int rays, size_t element, TracedHits& out) {
  const auto add = [&](uint16_t& counter) { counter = uint16_t(int(counter) + rays); };
  if (end == RayEnd::back) add(out.met_back[element]);
  if (end == RayEnd::behind) add(out.met_double_sided_back[element]);
  if (end == RayEnd::escaped) add(out.escaped[element]);
}

bool is_hit(RayEnd end) { return end == RayEnd::hit || end == RayEnd::behind; }

/// Sets look.light to the radiance outside along rays of the batch, without the tint of things that
/// they have passed.
void look_outside(const RayScene& in, const RayBatch& batch, OutsideLook& look) {
  look.directions.clear();
  for (const uint32_t k : look.rays) look.directions.push_back(batch.rays[k].direction);
  light::soft_radiance(in.scene, in.around, look.directions, look.light);
}

/// Light of the batch's escaped rays, all of which have a direction.
EscapedLight escaped_light(const RayScene& in, RayBuffers& buffers, Samples samples,
                           std::span<const RayEnd> ends) {
  OutsideLook& look = buffers.outside;
  look.rays.clear();
  for (uint32_t k = 0; k < ends.size(); ++k)
    if (ends[k] == RayEnd::escaped) look.rays.push_back(k);
  look_outside(in, buffers.batch, look);
  EscapedLight out;
  for (size_t at = 0; at < look.rays.size(); ++at) {
    const uint32_t k = look.rays[at];
    const Rgb l = buffers.tint.empty() ? look.light[at] : look.light[at] * buffers.tint[k];
    out.add(l * buffers.batch.weight_of(k), buffers.batch.in_second_half(k, samples));
  }
  return out;
}

/// Light of the escaped rays from what was known: what was traced again no longer brings what it
/// brought.
EscapedLight escaped_light(const RayScene& in, RayBuffers& buffers, Samples samples,
                           const EarlierElement& before, std::span<const RayEnd> ends) {
  if (!before.escaped) return escaped_light(in, buffers, samples, ends);
  OutsideLook& look = buffers.outside;
  look.rays = buffers.retraced;
  look_outside(in, buffers.batch, look);
  EscapedLight out = *before.escaped;
  for (size_t at = 0; at < look.rays.size(); ++at) {
    const uint32_t k = look.rays[at];
    const Rgb l = look.light[at];
    const bool second_half = samples.in_second_half(buffers.batch.sample[k]);
    if (before.ends[k] == RayEnd::escaped) out.take_away(l, second_half);
    if (ends[k] == RayEnd::escaped)
      out.add(buffers.tint.empty() ? l : l * buffers.tint[k], second_half);
  }
  out.sum = max(out.sum, Rgb{}), out.luminance2 = std::max(out.luminance2, 0.0f);
  return out;
}

/// Notes the light of the element's escaped rays.
void add_escaped(const RayScene& in, const EscapedLight& light, size_t element, TracedHits& out,
                 RayTile& tile) {
  tile.escaped.push_back(light);
  out.sky[element] += light.sum, out.sky_luminance2[element] += light.luminance2;
  out.sky_first_less_second[element] += luminance(light.sum) - 2 * light.second_luminance;
  add_sky(in.layers, light.sum, element, out);
}

/// True: the map is not asked about the place that a ray has met, and its path goes on from there.
bool passes_map_by(const RayScene& in, const trace::Hit& hit) {
  return in.near != nullptr && map_answers(*in.near, hit) == MapAnswers::no;
}

/// Begins to look up what one of the batch's rays has met.
void look_up(const RayScene& in, RayBuffers& buffers, uint32_t ray) {
  PlacesMet& places = buffers.places;
  const trace::Hit& hit = buffers.hits[ray];
  PlacesMet::OfRay& out = places.of_ray[ray] = {};
  if (!shows_light(in, hit)) return;
  out.place = transport::lookup_place(in.atlas, hit.point());
  if (!in.sides || !in.sides->is_mixed(out.place.base) || passes_map_by(in, hit)) return;
  places.beside_walls.push_back(ray), places.points.push_back(hit.point());
}

/// Looks up beside walls.
void look_up_beside_walls(const RayScene& in, PlacesMet& places) {
  if (places.points.empty()) return;
  places.own.resize(places.points.size());
  transport::own_lookups(*in.sides, places.points, places.lookups, places.own);
  for (size_t i = 0; i < places.own.size(); ++i) {
    PlacesMet::OfRay& out = places.of_ray[places.beside_walls[i]];
    out = {places.own[i], places.own[i].base == transport::kReadsNothing.base};
  }
}

/// Looks up the surfaces that `count` rays of the batch have met; number_of(k) is the k-th one's
/// number in the batch.
template <class NumberOf>
void find_places(const RayScene& in, RayBuffers& buffers, size_t count, const NumberOf& number_of) {
  PlacesMet& places = buffers.places;
  places.of_ray.resize(buffers.hits.size());
  places.beside_walls.clear(), places.points.clear();
  for (size_t k = 0; k < count; ++k) look_up(in, buffers, number_of(k));
  look_up_beside_walls(in, places);
}

/// The path that begins where the batch's k-th ray ends.
NearPath path_from(const RayScene& in, const RayBuffers& buffers, size_t k, size_t element,
                   Samples samples) {
  NearPath path;
  path.element = uint32_t(element), path.ray = uint32_t(k), path.sample = buffers.batch.sample[k];
  path.seed = hash64(in.seed ^ 0x7ea4, element);
  path.second_half = buffers.batch.in_second_half(k, samples);
  path.doublings = buffers.batch.doublings_of(k);
  if (!buffers.tint.empty()) path.throughput = buffers.tint[k];
  path.hit = buffers.hits[k], path.is_plain = !path.hit.back_face;
  return path;
}

/// The batch's k-th ray is followed on.
bool is_followed(const RayScene& in, const RayBuffers& buffers, size_t k) {
  if (!in.near || (!buffers.tint.empty() && max_component(buffers.tint[k]) <= 0)) return false;
  const MapAnswers answers = map_answers(*in.near, buffers.hits[k]);
  return answers == MapAnswers::no ||
         (answers == MapAnswers::where_own && buffers.places.of_ray[k].has_no_texel);
}

/// The end of the batch's k-th ray. A ray to be followed on is added to buffers.near.paths.
RayEnd end_of(const RayScene& in, RayBuffers& buffers, size_t k, size_t element, Samples samples) {
  const trace::Hit& hit = buffers.hits[k];
  if (!hit.found()) return RayEnd::escaped;
  if (!shows_light(in, hit)) return RayEnd::back;
  if (is_followed(in, buffers, k)) {
    buffers.near.paths.push_back(path_from(in, buffers, k, element, samples));
    return RayEnd::followed;
  }
  return hit.back_face ? RayEnd::behind : RayEnd::hit;
}

/// Notes a ray's hit then as lost and that now as won; null: no hit. Most meet what they met.
void note_change(const RayScene& in, const StoredHit* then, const StoredHit* now, size_t element,
                 TracedHits& out) {
  if (then && now && then->bits == now->bits) return;
  if (then) gather::note_change(in, *then, -1, element, out);
  if (now) gather::note_change(in, *now, 1, element, out);
}

/// The element whose rays are sorted, and which of its samples they are.
struct RaysOf {
  size_t element;
  Samples samples;
};

/// Counts the end of a ray that was traced, and keeps its hit.
void take_traced(const RayBuffers& buffers, size_t k, RayEnd end, const RaysOf& rays,
                 TracedHits& out, RayTile& tile) {
  const auto [element, samples] = rays;
  const bool counts = !is_guided(out, element);
  if (end == RayEnd::followed) {
    if (counts && buffers.near.paths.back().hit.back_face) ++out.met_double_sided_back[element];
    return;
  }
  if (counts) count_ends(end, 1, element, out);
  if (!is_hit(end)) return;
  const uint32_t sample = buffers.batch.sample[k];
  const uint32_t tint = buffers.tint.empty()
                            ? kNoTint
                            : pack_tint(buffers.tint[k], hash64(element, sample ^ 0x7147u));
  tile.hits.entries.push_back(
      store(buffers.places.of_ray[k].place,
            {tint, buffers.batch.in_second_half(k, samples), buffers.batch.doublings_of(k)}));
}

}  // namespace

bool shows_light(const RayScene& in, const trace::Hit& hit) {
  return hit.found() &&
         (!hit.back_face || scene::reflects_from_behind(scene::material_at(in.scene, hit.point())));
}

void add_sky(const light::LightLayers* layers, Rgb l, size_t element, TracedHits& out) {
  if (layers && layers->of_surroundings)
    out.sky_by_layer[element * layers->size() + *layers->of_surroundings] += l;
}

void note_change(const RayScene& in, StoredHit hit, float sign, size_t element, TracedHits& out) {
  if (!in.sent || out.unknown[element]) return;
  const Float4 b = lookup(*in.sent, hit);
  out.change[element] += Rgb{b[0], b[1], b[2]} * sign;
}

StoredHit store(const transport::LookupPlace& place, StoredHit::Ray ray) {
  constexpr float kSteps = float(StoredHit::kSteps);
  return StoredHit::pack(place.base, uint32_t(place.fx * kSteps + 0.5f),
                         uint32_t(place.fy * kSteps + 0.5f), ray);
}

StoredHit store(const RayScene& in, const scene::SurfacePoint& p, StoredHit::Ray ray,
                transport::MayBeInside inside) {
  return store(
      in.sides ? transport::own_lookup(*in.sides, p, inside) : transport::lookup_place(in.atlas, p),
      ray);
}

void sort_rays(const RayScene& in, RayBuffers& buffers, size_t element, Samples samples,
               TracedHits& out, RayTile& tile) {
  const size_t count = buffers.batch.rays.size();
  find_places(in, buffers, count, [](size_t k) { return uint32_t(k); });
  for (size_t k = 0; k < count; ++k) {
    const RayEnd end = end_of(in, buffers, k, element, samples);
    tile.ends.push_back(end);
    take_traced(buffers, k, end, {element, samples}, out, tile);
  }
  const std::span<const RayEnd> ends = std::span(tile.ends).last(count);
  add_escaped(in, escaped_light(in, buffers, samples, ends), element, out, tile);
}

void merge_rays(const RayScene& in, RayBuffers& buffers, size_t element, Samples samples,
                const EarlierElement& before, TracedHits& out, RayTile& tile) {
  const size_t count = before.ends.size();
  LUXEL_CHECK(count == samples.count());
  tile.ends.insert(tile.ends.end(), before.ends.begin(), before.ends.end());
  const std::span<RayEnd> ends = std::span(tile.ends).last(count);
  for (const RayEnd end : {RayEnd::back, RayEnd::behind, RayEnd::escaped})
    count_ends(end, int(count_of(before.ends, end)), element, out);
  find_places(in, buffers, buffers.retraced.size(), [&](size_t k) { return buffers.retraced[k]; });
  size_t next = 0, hit = 0;
  // The hits of rays from `next` on, up to `end`, stay.
  const auto keep_up_to = [&](size_t end) {
    const std::span<const RayEnd> kept = before.ends.subspan(next, end - next);
    const size_t stay = count_of(kept, RayEnd::hit) + count_of(kept, RayEnd::behind);
    const auto from = before.hits.begin() + std::ptrdiff_t(hit);
    tile.hits.entries.insert(tile.hits.entries.end(), from, from + std::ptrdiff_t(stay));
    next = end, hit += stay;
  };
  for (const uint32_t k : buffers.retraced) {
    keep_up_to(k);
    const RayEnd known = before.ends[k];
    count_ends(known, -1, element, out);
    ends[k] = end_of(in, buffers, k, element, samples);
    take_traced(buffers, k, ends[k], {element, samples}, out, tile);
    const StoredHit* then = is_hit(known) ? &before.hits[hit++] : nullptr;
    const StoredHit* now = is_hit(ends[k]) ? &tile.hits.entries.back() : nullptr;
    note_change(in, then, now, element, out);
    next = k + 1;
  }
  keep_up_to(count);
  const EscapedLight escaped = escaped_light(in, buffers, samples, before, ends);
  if (in.sent && before.escaped) out.change[element] += (escaped.sum - before.escaped->sum) * kPi;
  add_escaped(in, escaped, element, out, tile);
}

}  // namespace luxel::gather
