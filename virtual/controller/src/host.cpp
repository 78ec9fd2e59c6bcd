#include "metier/virtual_controller/host.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <asio/post.hpp>
#include <nlohmann/json.hpp>
#include <utility>

#include "metier/base/text.hpp"
#include "metier/virtual_controller/remote_world.hpp"
#include "open_connections.hpp"

namespace metier::virtual_controller {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kLookForSolitude{10};

Result<std::uint32_t> wholeNumber(const Injection& injection, std::uint32_t limit) {
    const auto number = numberIn<std::uint32_t>(injection.value);
    if (!number || *number > limit) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} needs a whole number, 0 to {}; not \"{}\"", injection.name,
                                limit, injection.value));
    }
    return *number;
}

/// The faults that every controller has.
const std::vector<InjectionHelp>& commonInjections() {
    static const std::vector<InjectionHelp> kHelp{
        {"cut-link", "Nothing comes through any port, and no peer is told"},
        {"restore-link", "Ends cut-link, delay and garble"},
        {"delay", "Everything is sent later by MS milliseconds, 0 to 10000"},
        {"garble", "One byte of each of the next N packets is changed, 0 to 1000"},
        {"restart", "Power off and on: every connection breaks"},
    };
    return kHelp;
}

std::string knownTypes(const std::vector<ControllerType>& types) {
    std::vector<std::string_view> names;
    for (const auto& type : types) {
        names.push_back(type.name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

Result<std::unique_ptr<Host>> Host::start(HostOptions options,
                                          const std::vector<ControllerType>& types) {
    const auto type = std::find_if(types.begin(), types.end(),
                                   [&](const auto& known) { return known.name == options.type; });
    if (type == types.end()) {
        return fail(Errc::invalid_argument,
                    fmt::format("no virtual controller of type \"{}\"; there are: {}", options.type,
                                knownTypes(types)));
    }
    std::unique_ptr<Host> host(new Host());
    if (options.world_address.empty()) {
        host->world_ = std::make_unique<EmptyWorld>();
    } else {
        host->world_ =
            std::make_unique<RemoteWorld>(host->context_, options.name, options.world_address);
    }
    METIER_ASSIGN(auto controller, type->start({host->context_, options.name, options.address,
                                                std::move(options.settings), options.model,
                                                host->faults_, *host->world_}));
    host->controller_ = std::move(controller);
    auto control = TcpServer::listen(
        host->context_, options.address, options.control_port, host->no_faults_,
        {.on_connected = {},
         .on_data =
             [self = host.get()](TcpPeer& peer, auto bytes) {
                 self->lines_.add(peer, bytes, [&](std::string_view line) {
                     peer.send(self->controlAnswer(line).dump() + '\n');
                 });
             },
         .on_closed = [self = host.get()](TcpPeer& peer) { self->lines_.forget(peer); }});
    if (!control) {
        return fail(control.error());
    }
    host->control_ = std::move(*control);
    return host;
}

Host::~Host() = default;

void Host::stopOnceAlone(std::chrono::milliseconds longest) {
    asio::post(context_, [this, deadline = std::chrono::steady_clock::now() + longest] {
        awaitSolitude(deadline);
    });
}

void Host::awaitSolitude(SteadyTime deadline) {
    if (OpenConnections::of(context_).count == 0 || std::chrono::steady_clock::now() >= deadline) {
        context_.stop();
        return;
    }
    solitude_.expires_after(kLookForSolitude);
    solitude_.async_wait([this, deadline](const asio::error_code& error) {
        if (!error) {
            awaitSolitude(deadline);
        }
    });
}

Json Host::controlAnswer(std::string_view line) {
    const auto request = Json::parse(line, nullptr, false);
    if (request.is_object() && request.contains("inject") && request.at("inject").is_string()) {
        const Injection injection{request.at("inject").get<std::string>(),
                                  request.contains("value") && request.at("value").is_string()
                                      ? request.at("value").get<std::string>()
                                      : std::string()};
        if (const auto done = inject(injection); !done) {
            return {{"error", done.error().message}};
        }
        return {{"ok", true}};
    }
    if (request.is_object() && request.contains("state")) {
        return controller_->state();
    }
    if (request.is_object() && request.contains("help")) {
        auto answer = Json::object();
        for (const auto& known : injections()) {
            answer[known.name] = known.help;
        }
        return answer;
    }
    return {
        {"error", R"(needs {"inject": NAME, "value": TEXT}, {"state": true} or {"help": true})"}};
}

std::vector<InjectionHelp> Host::injections() const {
    auto all = controller_->injections();
    all.insert(all.end(), commonInjections().begin(), commonInjections().end());
    return all;
}

Result<void> Host::inject(const Injection& injection) {
    if (injection.name == "cut-link") {
        faults_.cut = true;
    } else if (injection.name == "restore-link") {
        faults_.cut = false;
        faults_.delay_ms = 0;
        faults_.garble = 0;
    } else if (injection.name == "restart") {
        controller_->restart();
    } else if (injection.name == "delay" || injection.name == "garble") {
        const bool delay = injection.name == "delay";
        METIER_ASSIGN(const auto number, wholeNumber(injection, delay ? 10'000 : 1'000));
        (delay ? faults_.delay_ms : faults_.garble) = number;
    } else {
        const auto all = injections();
        const auto known = std::any_of(all.begin(), all.end(), [&](const auto& entry) {
            return entry.name == injection.name;
        });
        if (!known) {
            std::vector<std::string> names;
            for (const auto& entry : all) {
                names.push_back(entry.name);
            }
            return fail(Errc::not_found, fmt::format("nothing called \"{}\" can be injected here; "
                                                     "there are: {}",
                                                     injection.name, fmt::join(names, ", ")));
        }
        return controller_->inject(injection);
    }
    return {};
}

}  // namespace metier::virtual_controller
