#include "luxel/view/hierarchical/probe_worker.h"

#include <condition_variable>
#include <mutex>
#include <thread>

namespace luxel::view {
namespace {

class ProbeThread : public ProbeWorker {
 public:
  ProbeThread() {
    thread_ = std::thread([this] { work(); });
  }
  ~ProbeThread() override {
    {
      const std::scoped_lock lock(mutex_);
      ends_ = true, waiting_.clear();
      if (running_) running_->request_cancel();
    }
    has_news_.notify_all();
    thread_.join();
  }

  void ask(QuestionKind kind, Question question) override {
    {
      const std::scoped_lock lock(mutex_);
      std::erase_if(waiting_, [&](const Waiting& w) { return w.kind == kind; });
      if (running_ && running_kind_ == kind) running_->request_cancel();
      waiting_.push_back({kind, std::move(question)});
    }
    has_news_.notify_all();
  }

  void forget() override {
    const std::scoped_lock lock(mutex_);
    waiting_.clear(), answers_.clear();
    if (running_) running_->request_cancel();
  }

  std::vector<Answer> take() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(answers_, {});
  }

  bool is_at_work() const override {
    const std::scoped_lock lock(mutex_);
    return running_ || !waiting_.empty() || !answers_.empty();
  }

 private:
  struct Waiting {
    QuestionKind kind;
    Question question;
  };

  /// The next question; none when there will be no other.
  std::optional<Waiting> next(std::shared_ptr<Progress>& progress) {
    std::unique_lock lock(mutex_);
    running_.reset();
    has_news_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (ends_) return std::nullopt;
    Waiting out = std::move(waiting_.front());
    waiting_.erase(waiting_.begin());
    progress = running_ = std::make_shared<Progress>(), running_kind_ = out.kind;
    return out;
  }

  void work() {
    std::shared_ptr<Progress> progress;
    while (const auto asked = next(progress)) {
      Result<Answer> answer = asked->question(*progress);
      const std::scoped_lock lock(mutex_);
      // Asked anew, or forgotten, in the meantime.
      if (progress->cancelled()) continue;
      answers_.push_back(answer ? std::move(*answer) : Answer(answer.error().message));
    }
  }

  mutable std::mutex mutex_;
  std::condition_variable has_news_;
  std::vector<Waiting> waiting_;
  std::vector<Answer> answers_;
  std::shared_ptr<Progress> running_;  ///< of the question that is being answered
  QuestionKind running_kind_ = QuestionKind::light;
  bool ends_ = false;
  std::thread thread_;  ///< the last member: it looks at the others
};

}  // namespace

std::unique_ptr<ProbeWorker> ProbeWorker::begin() { return std::make_unique<ProbeThread>(); }

}  // namespace luxel::view
