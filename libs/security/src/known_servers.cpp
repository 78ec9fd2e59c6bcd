#include "metier/security/known_servers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <system_error>

#include "holdings.hpp"
#include "metier/base/stable_hash.hpp"
#include "metier/base/text.hpp"
#include "private_file.hpp"

namespace metier::security {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMost = 1'000;
constexpr std::size_t kReadable = 100;  // characters of an address in a file's name

/// "host:port" in small letters.
std::string addressIn(const std::string& url) {
    constexpr std::string_view kScheme = "opc.tcp://";
    auto address = inLowerCase(url);
    if (address.starts_with(kScheme)) {
        address.erase(0, kScheme.size());
    }
    address.erase(std::min(address.find('/'), address.size()));
    const auto end_of_host = address.find(']') == std::string::npos ? 0 : address.find(']');
    const auto colon = address.find(':', end_of_host);
    const auto host = address.substr(0, colon);
    const auto port = colon == std::string::npos ? "" : address.substr(colon + 1);
    const bool here = host == "127.0.0.1" || host == "[::1]" || host == "localhost";
    return fmt::format("{}:{}", here ? "localhost" : host, port.empty() ? "4840" : port);
}

bool isPlain(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-';
}

}  // namespace

fs::path KnownServers::fileOf(const std::string& url) const {
    const auto address = addressIn(url);
    auto readable = address.substr(0, kReadable);
    std::replace_if(
        readable.begin(), readable.end(), [](char c) { return !isPlain(c); }, '_');
    return folder_ / fmt::format("{}~{:016x}", readable, stableHash(address));
}

bool KnownServers::isClosed(const std::string& url) const {
    std::error_code error;
    // A file that cannot be examined may exist.
    return fs::exists(fileOf(url), error) || (error && error != std::errc::not_a_directory);
}

Result<void> KnownServers::noteClosed(const std::string& url) const {
    std::error_code error;
    if (fs::exists(fileOf(url), error)) {
        return {};
    }
    makeRoom(folder_, kMost);
    return writeWhole(fileOf(url), addressIn(url) + "\n", Readers::owner);
}

Result<bool> KnownServers::forget(const std::string& url) const {
    std::error_code error;
    const bool known = fs::remove(fileOf(url), error);
    return error && error != std::errc::not_a_directory ? failed(fileOf(url), error.value())
                                                        : Result<bool>(known);
}

}  // namespace metier::security
