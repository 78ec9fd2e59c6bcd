#include "cable.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sched.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace metier::system_tests {
namespace {

constexpr const char* kNear = "metier0";
constexpr const char* kFar = "metier1";
constexpr const char* kFarAddress = "10.77.0.2";
// Before connection tracking, on what arrives: TCP notices nothing of the loss at its own end.
constexpr const char* kChain = "{ type filter hook prerouting priority -300; }";

SteadyTime soon() {
    return std::chrono::steady_clock::now() + std::chrono::seconds(10);
}

std::string run(const std::vector<std::string>& command) {
    auto child = link::ChildProcess::start(command, link::ErrorOutput::with_output);
    if (!child) {
        throw std::runtime_error(child.error().message);
    }
    std::string output;
    for (auto line = child->readLine(soon()); line; line = child->readLine(soon())) {
        output += *line + "\n";
    }
    if (child->waitUntil(soon()) != 0) {
        throw std::runtime_error(fmt::format("{}: {}", fmt::join(command, " "), output));
    }
    return output;
}

link::ChildProcess farNamespace() {
    if (::unshare(CLONE_NEWNET) != 0) {
        throw std::system_error(errno, std::generic_category(), "a network namespace");
    }
    auto child =
        link::ChildProcess::start({"unshare", "--net", "sh", "-c", "echo up; exec sleep infinity"});
    if (!child || !child->readLine(soon())) {
        throw std::runtime_error("no second network namespace");
    }
    return std::move(*child);
}

std::vector<std::string> words(const std::string& text) {
    return {"sh", "-e", "-c", text};
}

}  // namespace

std::string Cable::obstacle() {
    if (::geteuid() != 0) {
        return "network namespaces need root";
    }
    try {
        run({"unshare", "--net", "sh", "-e", "-c",
             "ip link add near type veth peer name far; nft add table ip metier"});
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return {};
}

Cable::Cable() : far_end_(farNamespace()) {
    run(
        words(fmt::format("ip link set lo up; "
                          "ip link add {0} type veth peer name {1} netns {2}; "
                          "ip addr add {3}/30 dev {0}; ip link set {0} up; "
                          "echo 1 > /proc/sys/net/ipv4/conf/{0}/route_localnet; "
                          "nft add table ip metier; nft add chain ip metier in '{4}'; "
                          "nft add table ip to_loopback; "
                          "nft add chain ip to_loopback in "
                          "'{{ type nat hook prerouting priority -100; }}'; "
                          "nft add rule ip to_loopback in iifname {0} tcp dport 1-65535 "
                          "dnat to 127.0.0.1",
                          kNear, kFar, far_end_.pid(), kNearAddress, kChain)));
    run(
        atFarEnd(words(fmt::format("ip link set lo up; ip addr add {1}/30 dev {0}; "
                                   "ip link set {0} up; nft add table ip metier; "
                                   "nft add chain ip metier in '{2}'",
                                   kFar, kFarAddress, kChain))));
}

std::vector<std::string> Cable::atFarEnd(std::vector<std::string> command) const {
    command.insert(command.begin(),
                   {"nsenter", fmt::format("--net=/proc/{}/ns/net", far_end_.pid())});
    return command;
}

void Cable::enterFarEnd() const {
    const int far = ::open(fmt::format("/proc/{}/ns/net", far_end_.pid()).c_str(), O_RDONLY);
    const bool entered = far >= 0 && ::setns(far, CLONE_NEWNET) == 0;
    ::close(far);
    if (!entered) {
        throw std::system_error(errno, std::generic_category(), "the far network namespace");
    }
}

std::string Cable::addressOf(const std::string& url) {
    return fmt::format("opc.tcp://{}{}", kNearAddress, url.substr(url.rfind(':')));
}

void Cable::unplug() {
    run({"ip", "link", "set", kNear, "down"});
}

void Cable::dropEverything() {
    dropWhatComes();
    run(atFarEnd(words(fmt::format("nft add rule ip metier in iifname {} counter drop", kFar))));
}

void Cable::dropWhatComes() {
    run(words(fmt::format("nft add rule ip metier in iifname {} counter drop", kNear)));
}

void Cable::lose(int percent) {
    const auto rule = [percent](const char* interface) {
        return words(
            fmt::format("nft add rule ip metier in iifname {} numgen random mod 1000 '<' {} "
                        "counter drop",
                        interface, percent * 10));
    };
    run(rule(kNear));
    run(atFarEnd(rule(kFar)));
}

void Cable::slowDown(int bits_per_second, std::chrono::milliseconds queue) {
    run(words(fmt::format("tc qdisc add dev {} root tbf rate {}bit burst 5kb latency {}ms", kNear,
                          bits_per_second, queue.count())));
}

void Cable::restore() {
    run({"ip", "link", "set", kNear, "up"});
    run({"nft", "flush", "chain", "ip", "metier", "in"});
    run(atFarEnd({"nft", "flush", "chain", "ip", "metier", "in"}));
}

std::string Cable::lossCounts() const {
    const auto counts = words("nft list chain ip metier in | grep -o 'packets [0-9]*' || true");
    return run(counts) + run(atFarEnd(counts));
}

}  // namespace metier::system_tests
