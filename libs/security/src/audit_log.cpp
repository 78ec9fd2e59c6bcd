#include "metier/security/audit_log.hpp"

#include <fmt/format.h>

#include <iterator>

#include "chain.hpp"
#include "chained_file.hpp"

namespace metier::security {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostWaiting = 10'000;
constexpr auto kRetry = 1s;

Entry note(std::string event, std::string name, std::string value) {
    return {
        std::chrono::system_clock::now(), std::move(event), {{std::move(name), std::move(value)}}};
}

}  // namespace

Result<std::unique_ptr<AuditLog>> AuditLog::open(Options options) {
    std::size_t dropped = 0;
    METIER_ASSIGN(auto file, File::open(options.file, options.part_size, dropped));
    std::unique_ptr<AuditLog> log(new AuditLog(std::move(options), std::move(file)));
    if (dropped > 0) {
        log->append(note("LineDropped", "bytes", std::to_string(dropped)));
    }
    return log;
}

AuditLog::AuditLog(Options options, std::unique_ptr<File> file)
    : options_(std::move(options)), file_(std::move(file)), anchor_(file_->chain()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

AuditLog::~AuditLog() {
    thread_.request_stop();
    thread_ = {};
}

void AuditLog::append(Entry entry) {
    {
        const std::lock_guard lock(mutex_);
        if (waiting_.size() >= kMostWaiting) {
            ++lost_;
            return;
        }
        waiting_.push_back(std::move(entry));
        ++appended_;
    }
    changed_.notify_all();
}

std::size_t AuditLog::waiting() const {
    const std::lock_guard lock(mutex_);
    return waiting_.size();
}

bool AuditLog::flush(SteadyTime deadline) {
    std::unique_lock lock(mutex_);
    const auto all = appended_;
    return changed_.wait_until(lock, deadline, [&] { return written_ >= all; });
}

std::string AuditLog::anchor() const {
    const std::lock_guard lock(mutex_);
    return anchor_;
}

void AuditLog::run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, stop, [this] { return !waiting_.empty(); });
        if (waiting_.empty()) {
            return;  // asked to stop, and everything is written
        }
        const std::vector<Entry> batch(waiting_.begin(), waiting_.end());
        const auto lost = lost_;
        lock.unlock();
        const bool done = write(batch, lost);
        lock.lock();
        if (done) {
            waiting_.erase(waiting_.begin(),
                           waiting_.begin() + static_cast<std::ptrdiff_t>(batch.size()));
            written_ += batch.size();
            anchor_ = file_->chain();
            lost_ -= lost;
            changed_.notify_all();
        } else if (stop.stop_requested()) {
            return;
        } else {
            changed_.wait_for(lock, stop, kRetry, [] { return false; });
        }
    }
}

bool AuditLog::write(const std::vector<Entry>& entries, std::uint64_t lost) {
    auto all = entries;
    if (lost > 0) {
        all.push_back(note("EntriesLost", "count", std::to_string(lost)));
    }
    const auto written = file_->write(all);
    tell(written ? WriteState::writing : WriteState::failing,
         written ? std::string() : written.error().message);
    return written.has_value();
}

void AuditLog::tell(WriteState write_state, const std::string& why) {
    if (std::exchange(write_state_, write_state) != write_state && options_.on_write_state) {
        options_.on_write_state(write_state, why);
    }
}

}  // namespace metier::security
