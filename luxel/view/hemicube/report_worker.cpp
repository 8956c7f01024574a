#include "luxel/view/hemicube/report_worker.h"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace luxel::view {
namespace {

class ReportThread : public ReportWorker {
 public:
  ReportThread() : thread_([this] { work(); }) {}
  ~ReportThread() override {
    {
      const std::scoped_lock lock(mutex_);
      ends_ = true;
      if (progress_) progress_->request_cancel();
    }
    has_changed_.notify_all();
    thread_.join();
  }

  void ask(ReportRequest request) override {
    const std::scoped_lock lock(mutex_);
    asked_ = std::move(request);
    news_.reset();
    if (progress_) progress_->request_cancel();
    has_changed_.notify_all();
  }
  std::optional<ReportNews> take() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(news_, std::nullopt);
  }
  bool is_busy() const override {
    const std::scoped_lock lock(mutex_);
    return asked_ || progress_ || news_;
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      has_changed_.wait(lock, [this] { return ends_ || asked_; });
      if (ends_) return;
      ReportRequest request = *std::exchange(asked_, std::nullopt);
      progress_ = std::make_unique<Progress>();
      Progress& progress = *progress_;
      lock.unlock();
      ReportNews news = answer(std::move(request), progress);
      lock.lock();
      progress_.reset();
      if (!asked_ && !ends_) news_ = std::move(news);
    }
  }
  static ReportNews answer(ReportRequest request, Progress& progress) try {
    ReportNews out{request.mesh, {}, {}};
    auto report = report_on(*request.mesh, std::move(request.irradiance), request.element,
                            request.resolution, progress);
    if (report)
      out.report = std::move(*report);
    else
      out.said = report.error().message;
    return out;
  } catch (const std::bad_alloc&) {
    return {nullptr, {}, "out of memory: make the hemicube smaller"};
  }

  mutable std::mutex mutex_;  ///< of all that follows
  std::condition_variable has_changed_;
  std::optional<ReportRequest> asked_;
  std::unique_ptr<Progress> progress_;  ///< of what is under way
  std::optional<ReportNews> news_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<ReportWorker> ReportWorker::begin() { return std::make_unique<ReportThread>(); }

}  // namespace luxel::view
