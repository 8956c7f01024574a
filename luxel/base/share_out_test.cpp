// Pieces of a stage among the members of a team: each once, known to all.
#include "luxel/base/share_out.h"

#include <gmock/gmock.h>

#include <atomic>
#include <numeric>
#include <set>

#include "luxel/base/parallel.h"
#include "luxel/base/team_test_support.h"

namespace luxel {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ShareOut, GivesEachPieceToOneMember) {
  constexpr size_t kPieces = 1000;
  std::vector<std::atomic<int>> times(kPieces);
  std::vector<size_t> own_of(3);
  as_team(3, [&](Team& team) {
    Progress progress;
    const auto own = share_out(&team, kPieces, progress, [&](size_t piece) { ++times[piece]; });
    ASSERT_TRUE(own);
    EXPECT_TRUE(std::ranges::is_sorted(*own));
    own_of[team.rank()] = own->size();
  });
  EXPECT_EQ(std::accumulate(own_of.begin(), own_of.end(), size_t(0)), kPieces);
  for (const auto& n : times) EXPECT_EQ(n, 1);
}

TEST(ShareOut, IsAllOfOneProcessWithoutATeam) {
  Progress progress;
  std::vector<int> times(10);
  const auto own = share_out(nullptr, 10, progress, [&](size_t piece) { ++times[piece]; });
  ASSERT_TRUE(own);
  EXPECT_EQ(own->size(), 10u);
  EXPECT_THAT(times, Each(1));
}

// Dear pieces lie together: a part of the pieces says what all take when it has some from
// everywhere. Of 20 that follow each other, each fifth of the pieces has one or more.
TEST(ShareOut, TakesPiecesFromEverywhere) {
  constexpr size_t kPieces = 1000;
  const ThreadLimit one(1);
  Progress progress;
  std::vector<size_t> order;
  ASSERT_TRUE(share_out(nullptr, kPieces, progress, [&](size_t piece) { order.push_back(piece); }));
  for (size_t first = 0; first + 20 <= kPieces; first += 20) {
    std::set<size_t> fifths;
    for (size_t k = first; k < first + 20; ++k) fifths.insert(order[k] / (kPieces / 5));
    EXPECT_EQ(fifths.size(), 5u) << first;
  }
}

// A member that is held up takes fewer pieces: here no more than it had at hand.
TEST(ShareOut, GivesSlowMembersLess) {
  std::vector<size_t> own_of(2);
  std::atomic<bool> other_has_ended{false};
  as_team(2, [&](Team& team) {
    Progress progress;
    const auto own = share_out(&team, 10'000, progress, [&](size_t) {
      while (team.rank() == 0 && !other_has_ended)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
    own_of[team.rank()] = own->size();
    if (team.rank() == 1) other_has_ended = true;
  });
  EXPECT_LT(own_of[0], 1000u);
  EXPECT_GT(own_of[1], 9000u);
}

// The first member's progress is that of all, units that were there already apart.
TEST(ShareOut, TellsTheFirstMemberWhatAllHaveDone) {
  Progress::Snapshot seen;
  std::atomic<int> others_have_ended{0};
  as_team(3, [&](Team& team) {
    Progress progress;
    progress.begin("stage", 90);
    ASSERT_TRUE(share_out(&team, 90, progress, [&](size_t piece) {
      while (team.rank() == 0 && others_have_ended < 2)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      piece % 3 == 0 ? progress.skip(1) : progress.advance(1);
    }));
    if (team.rank() > 0) ++others_have_ended;
    if (team.rank() == 0) seen = progress.snapshot();
  });
  EXPECT_EQ(seen.done, 90u);
  EXPECT_EQ(seen.skipped, 30u);
}

// Numbers, lists of any length, and messages that are sent in several parts.
TEST(ShareRanges, AreKnownToAllMembers) {
  constexpr size_t kCount = 40'000'000;  // bytes: three messages of each member
  as_team(2, [&](Team& team) {
    Progress progress;
    std::vector<uint32_t> value(kCount / 4);
    std::vector<uint8_t> low(value.size());
    const auto set = [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) value[i] = uint32_t(3 * i), low[i] = uint8_t(i);
    };
    ASSERT_TRUE(
        share_ranges(&team, value.size(), 1000, progress, set, std::span(value), std::span(low)));
    for (size_t i = 0; i < value.size(); ++i)
      ASSERT_TRUE(value[i] == uint32_t(3 * i) && low[i] == uint8_t(i)) << i;
    const auto squares = share_lists<int>(&team, 10, 3, progress, [](size_t begin, size_t end) {
      std::vector<int> out;
      for (size_t i = begin; i < end; ++i)
        if (i % 2 == 0) out.push_back(int(i * i));
      return out;
    });
    ASSERT_TRUE(squares);
    EXPECT_THAT(*squares, ElementsAre(0, 4, 16, 36, 64));
  });
}

TEST(KeepInShares, LeavesWhatAllHaveKept) {
  as_team(3, [&](Team& team) {
    Progress progress;
    std::vector<uint32_t> which(20);
    std::iota(which.begin(), which.end(), 0u);
    const auto rays = keep_in_shares(&team, which, progress, [](std::vector<uint32_t>& some) {
      const size_t looked_at = some.size();
      std::erase_if(some, [](uint32_t i) { return i % 5 != 0; });
      return Result<uint64_t>(looked_at);
    });
    ASSERT_TRUE(rays);
    EXPECT_EQ(*rays, 20u);
    EXPECT_THAT(which, ElementsAre(0, 5, 10, 15));
    EXPECT_EQ(*first_of(&team, team.rank() + 7, progress), 7u);
    EXPECT_EQ(*sum_of_members(&team, team.rank() + 1, progress), 6u);
  });
}

// Nobody waits for a member that cannot go on.
TEST(ShareOut, EndsForAllWhenOneGivesUp) {
  std::vector<std::string> messages(3);
  as_team(3, [&](Team& team) {
    Progress progress;
    if (team.rank() == 1) {
      team.give_up({ErrorCode::out_of_disk, "the disk is full"});
      return;
    }
    const auto own = share_out(&team, 1000, progress, [](size_t) {});
    ASSERT_FALSE(own);
    EXPECT_EQ(own.error().code, ErrorCode::out_of_disk);
    messages[team.rank()] = own.error().message;
  });
  EXPECT_THAT(messages[0], HasSubstr("process 1: the disk is full"));
  EXPECT_EQ(messages[0], messages[2]);
}

TEST(ShareOut, EndsWhenItIsCancelled) {
  as_team(2, [&](Team& team) {
    Progress progress;
    if (team.rank() == 0) progress.request_cancel();
    const auto own = share_out(&team, 10, progress, [](size_t) {});
    if (team.rank() > 0) return;
    ASSERT_FALSE(own);
    EXPECT_EQ(own.error().code, ErrorCode::cancelled);
    team.give_up(own.error());
  });
}

// One member has all pieces, in several messages.
TEST(Exchange, GoesOnUntilNobodyHasMore) {
  constexpr size_t kPieces = 100, kBytes = 1 << 20;
  as_team(2, [&](Team& team) {
    Progress progress;
    std::vector<uint32_t> own(team.rank() == 1 ? kPieces : 0);
    std::iota(own.begin(), own.end(), 0u);
    std::vector<int> taken(kPieces);
    const std::vector<std::byte> content(kBytes, std::byte(7));
    const PieceExchange pieces{
        kPieces, [&](size_t, ByteWriter& out) { out.put(std::span<const std::byte>(content)); },
        [&](size_t piece, uint32_t rank, ByteReader& in) {
          std::vector<std::byte> got(kBytes);
          in.get(std::span(got));
          taken[piece] += got == content && rank == 1;
          return in.ok;
        }};
    ASSERT_TRUE(exchange(&team, own, pieces, progress));
    EXPECT_THAT(taken, Each(team.rank() == 1 ? 0 : 1));
  });
}

// A member's data are read with care: a piece that does not exist, and half a piece, are errors.
TEST(Exchange, RefusesWhatIsNotWhole) {
  for (const bool unknown_piece : {true, false})
    as_team(2, [&](Team& team) {
      Progress progress;
      const std::vector<uint32_t> own{unknown_piece ? 9u : team.rank()};
      const PieceExchange pieces{2, [](size_t, ByteWriter& out) { out.put_value(uint16_t(1)); },
                                 [&](size_t, uint32_t, ByteReader& in) {
                                   unknown_piece ? void(in.get_value<uint16_t>())
                                                 : void(in.get_value<uint32_t>());
                                   return in.ok;
                                 }};
      const Status done = exchange(&team, own, pieces, progress);
      ASSERT_FALSE(done);
      EXPECT_THAT(done.error().message, HasSubstr("incomplete data"));
    });
}

}  // namespace
}  // namespace luxel
