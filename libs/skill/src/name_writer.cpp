#include "name_writer.hpp"

#include <fmt/format.h>

#include <utility>

namespace metier::skill {

NameWriter::NameWriter(std::unique_ptr<NameFile> file, std::chrono::milliseconds longest_wait)
    : file_(std::move(file)),
      longest_wait_(longest_wait),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

NameWriter::~NameWriter() {
    thread_.request_stop();
    thread_.join();
}

Result<void> NameWriter::add(Job job) {
    {
        const std::lock_guard lock(mutex_);
        const auto now = std::chrono::steady_clock::now();
        if (writing_since_ && now - *writing_since_ >= longest_wait_) {
            const auto since =
                std::chrono::duration_cast<std::chrono::milliseconds>(now - *writing_since_);
            return fail(Errc::resource_unavailable,
                        fmt::format("the disk has not taken the name of an execution for {} ms",
                                    since.count()));
        }
        waiting_.push_back(std::move(job));
    }
    changed_.notify_one();
    return {};
}

void NameWriter::run(const std::stop_token& stop) {
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, stop, [this] { return !waiting_.empty(); });
            if (waiting_.empty()) {
                return;
            }
            job = std::move(waiting_.front());
            waiting_.pop_front();
            writing_since_ = std::chrono::steady_clock::now();
        }
        auto written = write(job);
        {
            const std::lock_guard lock(mutex_);
            writing_since_.reset();
        }
        job.done(std::move(written));
    }
}

Result<void> NameWriter::write(const Job& job) {
    begins_anew_ = begins_anew_ || job.begins_anew;
    if (begins_anew_) {
        METIER_TRY(file_->beginAnew());
        begins_anew_ = false;
    }
    return file_->append(job.line);
}

}  // namespace metier::skill
