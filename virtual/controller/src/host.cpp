#include "metier/virtual_controller/host.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <asio/post.hpp>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "metier/base/text.hpp"
#include "metier/virtual_controller/remote_world.hpp"
#include "open_connections.hpp"

namespace metier::virtual_controller {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kLookForSolitude{10};

/// An injection that sets a number.
auto numberFor(std::atomic<std::uint32_t>& fault, std::string_view name, std::uint32_t limit) {
    return [&fault, name, limit](const std::string& value) -> Result<void> {
        const auto number = numberIn<std::uint32_t>(value);
        if (!number || *number > limit) {
            return fail(
                Errc::invalid_argument,
                fmt::format("{} needs a whole number, 0 to {}; not \"{}\"", name, limit, value));
        }
        fault = *number;
        return {};
    };
}

}  // namespace

Result<std::unique_ptr<Host>> Host::start(HostOptions options,
                                          const std::vector<ControllerType>& types) {
    const auto type = std::ranges::find(types, options.type, &ControllerType::name);
    if (type == types.end()) {
        std::vector<std::string_view> names;
        std::ranges::transform(types, std::back_inserter(names), &ControllerType::name);
        return fail(Errc::invalid_argument,
                    fmt::format("no virtual controller of type \"{}\"; there are: {}", options.type,
                                fmt::join(names, ", ")));
    }
    std::unique_ptr<Host> host(new Host());
    if (options.world_address.empty()) {
        host->world_ = std::make_unique<EmptyWorld>();
    } else {
        METIER_TRY(parseAddress(options.world_address));
        host->world_ =
            std::make_unique<RemoteWorld>(host->context_, options.name, options.world_address);
    }
    METIER_ASSIGN(host->controller_, type->start({host->context_, options.name, options.address,
                                                  std::move(options.settings), options.model,
                                                  host->faults_, *host->world_}));
    METIER_ASSIGN(
        host->control_,
        TcpServer::listen(
            host->context_, {options.address, options.control_port}, host->no_faults_,
            {.on_connected = {},
             .on_data =
                 [self = host.get()](TcpPeer& peer, auto bytes) {
                     self->lines_.add(peer, bytes, [&](std::string_view line) {
                         peer.send(self->controlAnswer(line).dump() + '\n');
                     });
                 },
             .on_closed = [self = host.get()](TcpPeer& peer) { self->lines_.forget(peer); }}));
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

OrderedJson Host::controlAnswer(std::string_view line) {
    const auto request = OrderedJson::parse(line, nullptr, false);
    if (request.is_object() && request.contains("inject") && request.at("inject").is_string()) {
        const Injection injection{request.at("inject").get<std::string>(),
                                  request.contains("value") && request.at("value").is_string()
                                      ? request.at("value").get<std::string>()
                                      : std::string()};
        if (const auto done = performOneOf(injections(), injection); !done) {
            return {{"error", done.error().message}};
        }
        return {{"ok", true}};
    }
    if (request.is_object() && request.contains("state")) {
        return controller_->state();
    }
    if (request.is_object() && request.contains("help")) {
        auto answer = OrderedJson::object();
        for (const auto& known : injections()) {
            answer[known.name] = known.help;
        }
        return answer;
    }
    return {
        {"error", R"(needs {"inject": NAME, "value": TEXT}, {"state": true} or {"help": true})"}};
}

/// Those of the controller, then the faults that every controller has.
std::vector<InjectionHelp> Host::injections() {
    auto all = controller_->injections();
    for (auto& known : all) {
        known.perform = [this, name = known.name](const std::string& value) {
            return controller_->inject({name, value});
        };
    }
    const std::vector<InjectionHelp> common{
        {"cut-link", "Nothing comes through any port, and no peer is informed",
         always([this] { faults_.cut = true; })},
        {"restore-link", "Ends cut-link, delay and garble", always([this] {
             faults_.cut = false;
             faults_.delay_ms = 0;
             faults_.garble = 0;
         })},
        {"delay", "Everything is sent later by MS milliseconds, 0 to 10000",
         numberFor(faults_.delay_ms, "delay", 10'000)},
        {"garble", "One byte of each of the next N packets is changed, 0 to 1000",
         numberFor(faults_.garble, "garble", 1'000)},
        {"restart", "Power off and on: every connection breaks",
         always([this] { controller_->restart(); })},
    };
    all.insert(all.end(), common.begin(), common.end());
    return all;
}

}  // namespace metier::virtual_controller
