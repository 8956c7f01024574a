#include "luxel/view/live/live_news.h"

namespace luxel::view {

void merge(LiveNews newer, LiveNews& news) {
  const bool is_other = newer.read || newer.lit;
  if (newer.read) news.read = std::move(newer.read);
  if (newer.said) news.said = std::move(newer.said);
  if (newer.probes) news.probes = std::move(newer.probes);
  // Light told apart in another layout or scene is of no use.
  if (newer.bounced || is_other) news.bounced = std::move(newer.bounced);
  if (newer.light || is_other || !newer.without_lamps.empty())
    news.without_lamps = std::move(newer.without_lamps);
  if (!newer.light) return;
  // Light of another layout comes with it; light before that is of no use.
  if (newer.lit) news.lit = std::move(newer.lit), news.before = std::move(newer.before);
  news.light = std::move(newer.light);
  news.warnings = std::move(newer.warnings);
}

}  // namespace luxel::view
