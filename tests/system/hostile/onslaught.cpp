#include "onslaught.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>

#include "closed_server.hpp"
#include "survey.hpp"
#include "target_process.hpp"
#include "watcher.hpp"

namespace metier::hostile {

namespace {

using Clock = std::chrono::steady_clock;

std::string preparedFolder(const OnslaughtOptions& options) {
    if (options.kind == ServerKind::open) {
        return {};
    }
    makeIdentities(options.folder);
    return options.folder;
}

opcua::ClientOptions watcherOptions(const std::string& folder) {
    return folder.empty() ? opcua::ClientOptions{} : clientOptionsIn(folder);
}

PublicCertificates certificatesIn(const std::string& folder) {
    if (folder.empty()) {
        return {};
    }
    const auto options = clientOptionsIn(folder);
    return {securityIn(folder).credentials.identity.certificate.der(),
            options.security->identity.certificate.der()};
}

class Onslaught {
public:
    explicit Onslaught(const OnslaughtOptions& options)
        : options_(options),
          folder_(preparedFolder(options)),
          target_(folder_),
          watcher_(target_.url(), watcherOptions(folder_)),
          map_(survey(watcher_.client())) {
        // The first of its connections is made, all that it opens once is open.
        report_.descriptors_before = target_.descriptors();
    }

    OnslaughtReport run() {
        const auto begin = Clock::now();
        attack();
        awaitDescriptors();
        report_.resident_after = target_.residentKilobytes();
        report_.longest_wait = watcher_.longestWait();
        report_.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        return std::move(report_);
    }

private:
    void attack() {
        std::vector<HostileClient> clients;
        clients.reserve(options_.clients);
        for (std::size_t i = 0; i < options_.clients; ++i) {
            clients.emplace_back(HostileClient::Target{target_.port(), target_.url(), options_.kind,
                                                       certificatesIn(folder_)},
                                 map_, report_.tally);
        }
        const auto end = options_.first + options_.messages;
        for (auto number = options_.first; number < end && report_.tally.defects.empty();
             ++number) {
            clients[number % clients.size()].send(options_.seed, number);
            if (number % options_.ask_every == 0) {
                ask(number);
            }
            if (number == options_.first + options_.messages / 2) {
                report_.resident_before = target_.residentKilobytes();
            }
        }
        ask(end);
    }

    void ask(std::uint64_t number) {
        constexpr std::uint64_t tell = 100'000;
        auto wrong = watcher_.ask();
        if (!target_.lives()) {
            wrong = "the server has ended";
        }
        if (!wrong.empty()) {
            report_.tally.defects.push_back(fmt::format("until message {}: {}", number, wrong));
        }
        if (options_.tells && number % tell == 0) {
            fmt::print("{} messages, longest wait {} ms, {} kB\n", number,
                       watcher_.longestWait().count(), target_.residentKilobytes());
            std::fflush(stdout);
        }
    }

    /// Waits for the end of the hostile clients' connections; the server closes its ends one by
    /// one.
    void awaitDescriptors() {
        const auto deadline = Clock::now() + std::chrono::minutes(1);
        do {
            ask(options_.first + options_.messages);
            if (!report_.tally.defects.empty()) {
                return;  // of a server that has ended there are no descriptors
            }
            report_.descriptors_after = target_.descriptors();
        } while (report_.descriptors_after > report_.descriptors_before && Clock::now() < deadline);
    }

    const OnslaughtOptions options_;
    const std::string folder_;
    TargetProcess target_;
    Watcher watcher_;
    const AddressMap map_;
    OnslaughtReport report_;
};

}  // namespace

OnslaughtReport runOnslaught(const OnslaughtOptions& options) {
    return Onslaught(options).run();
}

std::string describe(const OnslaughtOptions& options, const OnslaughtReport& report) {
    const auto& tally = report.tally;
    return fmt::format(
        "seed {}, messages {} to {}: {:.1f} s, {} connections, {} sessions, {} answers, {} faults; "
        "longest wait {} ms; {} kB, before {} kB; {} descriptors, before {}\n{}",
        options.seed, options.first, options.first + options.messages, report.seconds,
        tally.connections, tally.sessions, tally.answers, tally.faults, report.longest_wait.count(),
        report.resident_after, report.resident_before, report.descriptors_after,
        report.descriptors_before, fmt::join(tally.defects, "\n"));
}

}  // namespace metier::hostile
