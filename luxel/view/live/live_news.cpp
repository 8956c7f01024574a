#include "luxel/view/live/live_news.h"

namespace luxel::view {

void add(LiveNews newer, LiveNews& news) {
  if (newer.read) news.read = std::move(newer.read);
  if (newer.said) news.said = std::move(newer.said);
  if (newer.probes) news.probes = std::move(newer.probes);
  // What lies elsewhere is of no use, whatever it tells apart.
  if (newer.bounced || newer.lit) news.bounced = std::move(newer.bounced);
  if (!newer.light) return;
  // Light of another layout comes with it; light before that is of no use.
  if (newer.lit) news.lit = std::move(newer.lit), news.before = std::move(newer.before);
  news.light = std::move(newer.light);
  news.warnings = std::move(newer.warnings);
}

}  // namespace luxel::view
