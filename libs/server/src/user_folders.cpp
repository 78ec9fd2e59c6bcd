#include "metier/server/user_folders.hpp"

#include <unistd.h>

#include <array>
#include <cstdlib>

namespace metier::server {
namespace {

std::filesystem::path variable(const char* name) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): the environment never changes
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
}

std::filesystem::path folder(const char* name, const char* below_home) {
    if (const auto named = variable(name); named.is_absolute()) {
        return named / "metier";
    }
    const auto home = variable("HOME");
    return home.empty() ? home : home / below_home / "metier";
}

}  // namespace

std::filesystem::path userStateFolder() {
    return folder("XDG_STATE_HOME", ".local/state");
}

std::filesystem::path userConfigFolder() {
    return folder("XDG_CONFIG_HOME", ".config");
}

std::string hostName() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

}  // namespace metier::server
