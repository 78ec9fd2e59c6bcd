#include "password.hpp"

#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace metier::app {
namespace {

/// Hides what is typed until its end.
class Silence {
public:
    Silence() : is_terminal_(tcgetattr(STDIN_FILENO, &before_) == 0) {
        if (is_terminal_) {
            auto silent = before_;
            silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
            tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
        }
    }
    ~Silence() {
        if (is_terminal_) {
            tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
        }
    }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
    bool isTerminal() const noexcept { return is_terminal_; }

private:
    termios before_{};
    bool is_terminal_;
};

}  // namespace

Result<std::string> readPassword(const std::string& user) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): the environment never changes
    if (const char* given = std::getenv("METIER_PASSWORD"); given != nullptr) {
        return std::string(given);
    }
    const Silence silence;
    if (!silence.isTerminal()) {
        return fail(Errc::access_denied,
                    fmt::format("the password of {} is to be in METIER_PASSWORD, or to be typed "
                                "at a terminal",
                                user));
    }
    fmt::print(stderr, "password of {}: ", user);
    std::string password;
    std::getline(std::cin, password);
    fmt::print(stderr, "\n");
    return password;
}

}  // namespace metier::app
