#include "metier/skill/execution_names.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "disk_names.hpp"
#include "metier/base/clock.hpp"

namespace metier::skill {

namespace {

/// One line without its end, whatever the client's name holds.
std::string entryOf(std::string_view skill, std::string_view name) {
    std::string entry(skill);
    entry += '\t';
    for (const char letter : name) {
        if (letter == '%' || static_cast<unsigned char>(letter) < ' ') {
            entry += fmt::format("%{:02x}", static_cast<unsigned char>(letter));
        } else {
            entry += letter;
        }
    }
    return entry;
}

}  // namespace

/// Thread that writes names to their file, so that no other thread waits for the disk.
///
/// Threading: any. The destructor waits for the write that is under way, and for those in the
/// queue.
class NameWriter {
public:
    struct Job {
        std::string line;
        bool begins_anew = false;                  ///< the file, before this line
        std::function<void(Result<void>)> done{};  ///< called once, on the writing thread
    };

    /// \param longest_wait for one name, after which no more are taken
    NameWriter(std::unique_ptr<NameFile> file, std::chrono::milliseconds longest_wait);
    ~NameWriter();
    NameWriter(const NameWriter&) = delete;
    NameWriter& operator=(const NameWriter&) = delete;

    /// Errors: resource_unavailable: the disk hangs.
    Result<void> add(Job job);

private:
    void run(const std::stop_token& stop);
    Result<void> write(const Job& job);

    const std::unique_ptr<NameFile> file_;
    const std::chrono::milliseconds longest_wait_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<Job> waiting_;
    std::optional<SteadyTime> writing_since_;
    bool begins_anew_ = false;  ///< used by the thread only: the file must be begun anew
    std::jthread thread_;       // last: it uses everything above
};

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

ExecutionNames::ExecutionNames(std::size_t least) : least_(least) {}

ExecutionNames::ExecutionNames(std::unique_ptr<NameFile> file, const Options& options)
    : least_(options.least),
      writer_(std::make_unique<NameWriter>(std::move(file), options.longest_write)) {}

ExecutionNames::~ExecutionNames() = default;

Result<std::unique_ptr<ExecutionNames>> ExecutionNames::open(const std::filesystem::path& file,
                                                             std::size_t least) {
    DiskNames::Known known;
    METIER_ASSIGN(auto opened, DiskNames::open(file, known));
    auto names = std::make_unique<ExecutionNames>(std::move(opened), Options{.least = least});
    names->newer_ = std::move(known.newer);
    names->older_ = std::move(known.older);
    return names;
}

bool ExecutionNames::knows(std::string_view skill, std::string_view name) const {
    const auto entry = entryOf(skill, name);
    return newer_.contains(entry) || older_.contains(entry);
}

Result<ExecutionNames::Keeping> ExecutionNames::note(std::string_view skill, std::string_view name,
                                                     OnKept on_kept) {
    auto entry = entryOf(skill, name);
    const bool full = newer_.size() >= least_;
    if (writer_) {
        METIER_TRY(writer_->add({entry + "\n", full, std::move(on_kept)}));
    }
    if (full) {
        older_ = std::exchange(newer_, {});
    }
    newer_.insert(std::move(entry));
    return writer_ ? Keeping::under_way : Keeping::kept;
}

void ExecutionNames::forget(std::string_view skill, std::string_view name) {
    const auto entry = entryOf(skill, name);
    newer_.erase(entry);
    older_.erase(entry);
}

std::string forgottenText(std::string_view name) {
    return fmt::format("execution \"{}\" has begun once, and its record is gone", name);
}

}  // namespace metier::skill
