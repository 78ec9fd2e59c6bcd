// The clock of the computer, as a process sees it that is started with LD_PRELOAD of this: wrong by
// as many nanoseconds as the file named by METIER_CLOCK_OFFSET holds. Nothing else changes; timers
// and the steady clock are the kernel's.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// Shared with the test, which changes it.
const std::atomic<std::int64_t>* mapOffset() {
    static const std::atomic<std::int64_t> right{0};
    const char* name = std::getenv("METIER_CLOCK_OFFSET");  // NOLINT(concurrency-mt-unsafe)
    const int file = name == nullptr ? -1 : ::open(name, O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return &right;
    }
    void* shared = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
    ::close(file);
    return shared == MAP_FAILED ? &right : static_cast<const std::atomic<std::int64_t>*>(shared);
}

void shift(timespec& time) {
    static const auto* offset = mapOffset();
    const auto shifted = time.tv_sec * kSecond + time.tv_nsec + offset->load();
    time.tv_sec = shifted / kSecond;
    time.tv_nsec = shifted % kSecond;
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
    const auto result = static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
    if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) {
        shift(*time);
    }
    return result;
}

int gettimeofday(timeval* time, void* /*zone*/) noexcept {
    timespec now{};
    const int result = clock_gettime(CLOCK_REALTIME, &now);
    *time = {now.tv_sec, now.tv_nsec / 1'000};
    return result;
}

time_t time(time_t* seconds) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (seconds != nullptr) {
        *seconds = now.tv_sec;
    }
    return now.tv_sec;
}
}
