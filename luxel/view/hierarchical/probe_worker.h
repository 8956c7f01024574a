// A thread that answers what a probe asks: the window does not wait for exact light.
#pragma once

#include <functional>
#include <memory>
#include <variant>
#include <vector>

#include "luxel/view/hierarchical/curve.h"
#include "luxel/view/hierarchical/selection_facts.h"

namespace luxel::view {

/// A graph of light: along a line, and over an element or a triangle where one is selected.
struct Graph {
  Curve curve;
  std::optional<LightSurface> surface;
};

/// What came of a question. A sentence: why there is nothing.
using Answer =
    std::variant<std::string, DiscontinuityFacts, LightProbe, BackprojectionProbe, Graph>;
/// Computes an answer; it holds all that it looks at. Errors end as sentences, cancelled ones as
/// nothing.
using Question = std::function<Result<Answer>(Progress&)>;
/// The newest question of each kind counts.
enum class QuestionKind : uint8_t { discontinuity, light, sources, graph };

/// Guards the thread. Its functions are called by one thread and do not wait for an answer, but for
/// the destructor, which ends it within about 0.2 s.
class ProbeWorker {
 public:
  static std::unique_ptr<ProbeWorker> begin();
  virtual ~ProbeWorker() = default;

  /// Forgets an earlier question of this kind, and ends it if it is being answered.
  virtual void ask(QuestionKind kind, Question question) = 0;
  /// Forgets all questions and answers.
  virtual void forget() = 0;
  /// The answers that have come since the last call.
  virtual std::vector<Answer> take() = 0;
  /// Whether an answer is to come, or to be taken.
  virtual bool is_at_work() const = 0;
};

}  // namespace luxel::view
