#include "metier/base/random.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <cerrno>
#include <system_error>

namespace metier {

std::uint64_t randomNumber() {
    std::uint64_t number = 0;
    if (getrandom(&number, sizeof number, 0) != sizeof number) {
        throw std::system_error(errno, std::generic_category(), "random numbers");
    }
    return number;
}

std::string randomHex(std::size_t digits) {
    std::string text;
    while (text.size() < digits) {
        text += fmt::format("{:016x}", randomNumber());
    }
    text.resize(digits);
    return text;
}

}  // namespace metier
