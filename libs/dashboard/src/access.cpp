#include "access.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "metier/base/text.hpp"

namespace metier::dashboard {
namespace {

constexpr std::uint8_t kLoopbackNet = 127;

/// Without the port: "127.0.0.1", "::1", "localhost".
std::string hostOf(const std::string& header) {
    if (header.starts_with('[')) {
        const auto end = header.find(']');
        return end == std::string::npos ? "" : header.substr(1, end - 1);
    }
    return header.substr(0, header.find(':'));
}

bool isAddress(const std::string& host) {
    std::array<unsigned char, sizeof(in6_addr)> address{};
    return inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
           inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
}

/// ::ffff:127.0.0.1, as a socket for both kinds of addresses shows an IPv4 peer.
bool isMappedLoopback(const in6_addr& six) {
    constexpr std::size_t kFirstOfFour = 12;
    return IN6_IS_ADDR_V4MAPPED(&six) && six.s6_addr[kFirstOfFour] == kLoopbackNet;
}

}  // namespace

bool isLoopback(const std::string& address) {
    in6_addr six{};
    if (inet_pton(AF_INET6, address.c_str(), &six) == 1) {
        return IN6_IS_ADDR_LOOPBACK(&six) != 0 || isMappedLoopback(six);
    }
    in_addr four{};
    return address == "localhost" || (inet_pton(AF_INET, address.c_str(), &four) == 1 &&
                                      ntohl(four.s_addr) >> 24U == kLoopbackNet);
}

Result<void> checkLocal(const httplib::Request& request) {
    constexpr std::array kOfProxies{"Forwarded",         "X-Forwarded-For", "X-Forwarded-Host",
                                    "X-Forwarded-Proto", "X-Real-IP",       "Via"};
    const bool passed_on =
        std::any_of(kOfProxies.begin(), kOfProxies.end(),
                    [&](const char* header) { return request.has_header(header); });
    if (passed_on || !isLoopback(request.remote_addr) ||
        !isLoopback(hostOf(request.get_header_value("Host")))) {
        return fail(Errc::access_denied,
                    "nobody logs in here, so the page is for browsers of this machine alone, "
                    "without a proxy");
    }
    return {};
}

Result<void> checkOrigin(const httplib::Request& request, const std::string& host_name) {
    const auto header = request.get_header_value("Host");
    const auto host = hostOf(header);
    if (request.get_header_value_count("Host") != 1 ||
        !(isAddress(host) || host == "localhost" || (!host.empty() && host == host_name))) {
        return fail(
            Errc::access_denied,
            "the page is reached by an address, by localhost, or by the name of --host-name");
    }
    const auto origin = request.get_header_value("Origin");
    if (!origin.empty() && origin != "http://" + header && origin != "https://" + header) {
        return fail(Errc::access_denied, "the request comes from another page");
    }
    return {};
}

Result<void> checkIntent(const httplib::Request& request) {
    if (request.get_header_value("X-Metier") != "1") {
        return fail(Errc::access_denied, "the header X-Metier: 1 is missing");
    }
    if (!request.get_header_value("Content-Type").starts_with("application/json")) {
        return fail(Errc::invalid_argument, "Content-Type is to be application/json");
    }
    return {};
}

std::string sessionCookieName(const httplib::Request& request) {
    const auto header = request.get_header_value("Host");
    const auto port = header.find_last_not_of("0123456789") + 1;
    const bool has_port = port > 0 && port < header.size() && header[port - 1] == ':';
    return has_port ? "metier_" + header.substr(port) : "metier";
}

std::string cookie(const httplib::Request& request, const std::string& name) {
    const auto header = request.get_header_value("Cookie");
    for (const auto part : split(header, ';')) {
        const auto one = trimmed(part, " ");
        if (one.starts_with(name) && one.substr(name.size()).starts_with('=')) {
            return std::string(one.substr(name.size() + 1));
        }
    }
    return {};
}

httplib::Headers protectiveHeaders() {
    return {{"Content-Security-Policy",
             "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
             "font-src 'self'; connect-src 'self'; manifest-src 'self'; base-uri 'none'; "
             "form-action 'self'; frame-ancestors 'none'"},
            {"X-Content-Type-Options", "nosniff"},
            {"X-Frame-Options", "DENY"},
            {"Referrer-Policy", "no-referrer"},
            {"Cross-Origin-Resource-Policy", "same-origin"}};
}

}  // namespace metier::dashboard
