#include "jumping_clock.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

namespace metier::system_tests {

JumpingClock::JumpingClock() {
    auto name = (std::filesystem::temp_directory_path() / "metier_clock.XXXXXX").string();
    const int file = ::mkstemp(name.data());
    file_ = name;
    constexpr auto kSize = sizeof(std::int64_t);
    void* shared = file < 0 || ::ftruncate(file, kSize) != 0
                       ? MAP_FAILED
                       : ::mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (file >= 0) {
        ::close(file);
    }
    if (shared == MAP_FAILED) {
        throw std::system_error(errno, std::generic_category(), "a clock for another process");
    }
    offset_ = static_cast<std::atomic<std::int64_t>*>(shared);
}

JumpingClock::~JumpingClock() {
    ::munmap(offset_, sizeof(std::int64_t));
    std::error_code error;
    std::filesystem::remove(file_, error);
}

std::string JumpingClock::obstacle() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return "a sanitizer has the clock for itself";
#else
    return {};
#endif
}

void JumpingClock::set(std::chrono::nanoseconds ahead) {
    *offset_ = ahead.count();
}

std::vector<std::string> JumpingClock::of(std::vector<std::string> command) const {
    command.insert(command.begin(), {"env", std::string("LD_PRELOAD=") + METIER_CLOCK_PRELOAD,
                                     "METIER_CLOCK_OFFSET=" + file_.string()});
    return command;
}

}  // namespace metier::system_tests
