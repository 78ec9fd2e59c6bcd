// The control port of every virtual controller, whatever is asked there. The first byte chooses the
// controller; each line of the rest is a request, or the name and the value of an injection.
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "metier/virtual_controller/host.hpp"

namespace {

using namespace metier;
using namespace metier::virtual_controller;
using Values = std::map<std::string, cell::Settings::Value>;

// An address of this process alone, so that ports which have a fixed number are free.
std::string ownAddress(std::size_t index) {
    const auto process = static_cast<unsigned>(::getpid());
    return fmt::format("127.{}.{}.{}", 64 + (process >> 8U) % 128, process % 256, 1 + index);
}

/// Controllers of devices that are no arms take no notice of it.
const motion::RobotModel* modelOf(std::string_view type) {
    const auto load = [](const char* file) {
        return motion::RobotModel::load(std::string(METIER_MODELS_DIR "/") + file).value();
    };
    static const auto kIiwa = load("iiwa7.toml");
    static const auto kEdo = load("edo.toml");
    static const auto kSixAxes = load("ur5.toml");
    return type == "iiwa" ? &kIiwa : type == "edo" ? &kEdo : &kSixAxes;
}

Values settingsOf(std::string_view type) {
    if (type == "world") {
        return {{"part.cube", std::vector<double>{0.4, 0.0, 0.02, 0.04, 0.04, 0.04, 0.1}}};
    }
    return {};
}

std::vector<std::unique_ptr<Host>> startAll() {
    std::vector<std::unique_ptr<Host>> hosts;
    for (const auto& type : controllerTypes()) {
        const std::string name(type.name);
        auto host = Host::start({.name = name,
                                 .type = name,
                                 .address = ownAddress(hosts.size()),
                                 .settings = {name, settingsOf(type.name)},
                                 .model = modelOf(type.name),
                                 .world_address = {},
                                 .control_port = 0},
                                controllerTypes());
        if (!host) {
            std::fprintf(stderr, "%s: %s\n", name.c_str(), host.error().message.c_str());
            std::abort();
        }
        hosts.push_back(std::move(*host));
    }
    return hosts;
}

/// A line "name=value" as an injection; any other as it is.
std::string requestOf(const std::string& line) {
    const auto split = line.find('=');
    if (split == std::string::npos || line.starts_with('{')) {
        return line;
    }
    const nlohmann::json request{{"inject", line.substr(0, split)},
                                 {"value", line.substr(split + 1)}};
    return request.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto kHosts = startAll();
    if (size == 0) {
        return 0;
    }
    auto& host = *kHosts[data[0] % kHosts.size()];
    std::string_view rest(reinterpret_cast<const char*>(data + 1), size - 1);
    while (!rest.empty()) {
        const auto line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        const auto answer = host.controlAnswer(requestOf(std::string(line)));
        if (!answer.is_object() || answer.dump().empty()) {
            std::abort();
        }
    }
    // Handlers that have begun continue, but a late cycle does not make further cycles late.
    for (int handler = 0; handler < 4 && host.context().poll_one() > 0; ++handler) {
    }
    return 0;
}
