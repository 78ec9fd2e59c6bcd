#include "random_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace metier::dashboard {

std::string randomName() {
    std::array<std::uint8_t, 16> bytes{};
    if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
        throw std::system_error(errno, std::generic_category(), "random numbers");
    }
    return fmt::format("{:02x}", fmt::join(bytes, ""));
}

}  // namespace metier::dashboard
