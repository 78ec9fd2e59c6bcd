#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "metier/skill/executor.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "metier/skill/resource.hpp"
#include "metier/skill/skill.hpp"

namespace metier::server {

/// Facts about a server of skills of your own.
struct OwnServerOptions {
    /// Name of the server, and BrowseName of the controller that has its skills: "lamp".
    std::string name{};
    /// One line for people.
    std::string description{};
    /// URI of the namespace of its skill types, which belongs to whoever writes the program:
    /// "urn:example:lamp". Empty: "urn:metier:own:NAME".
    std::string types{};
    /// TCP port, unless the command line names another one; 0: a free one.
    std::uint16_t port = 0;
};

/// Facts about one skill of an OwnServer, besides its description.
struct OfferOptions {
    /// Tasks by which others find the skill: terms of metier's dictionary, such as "grasp", new
    /// ones, or URIs.
    std::vector<std::string> terms{};
    /// Device that only one skill may use at a time: give the same one to all skills of the device.
    /// Null: the skill runs beside all others.
    std::shared_ptr<skill::Resource> resource{};
};

/// A program that serves skills of your own over OPC UA: command line, server, skill types, trust,
/// control, records, and the end. It is the whole main():
///
///     int main(int argc, char** argv) {
///         bool lit = false;
///         metier::server::OwnServer lamp(argc, argv, {.name = "lamp", .port = 48491});
///         lamp.offer({.name = "ToggleSkill", .type = "ToggleSkillType"},
///                    {.start = [&lit](const auto&, const auto& execution) {
///                        lit = !lit;
///                        execution.finish();
///                    }});
///         return lamp.run();
///     }
///
/// Options of the command line, as those of `metier serve`: --port, --address, --security FOLDER,
/// --insecure-lab, --state FOLDER, --help. Without --insecure-lab the server is closed from its
/// first start: encryption, certificates, users and roles (docs/guide/security.md).
///
/// Errors are reported on standard error; run() then returns the exit status.
///
/// Threading: one thread, that of main(), makes and runs it; make it before any other thread, since
/// it blocks SIGINT, SIGTERM and SIGHUP in this one. Skills are called on the server's thread, and
/// only while run() runs, so they may refer to variables of main(), wherever these are declared.
class OwnServer {
public:
    /// Reads the command line and makes the server, which does not serve yet. Sends the log to
    /// standard error from now on.
    /// \param argv of main(): the name of the program, then its options
    /// Throws std::runtime_error if the system has no file descriptor left.
    OwnServer(int argc, const char* const* argv, OwnServerOptions options);
    ~OwnServer();
    OwnServer(const OwnServer&) = delete;
    OwnServer& operator=(const OwnServer&) = delete;

    /// Executor on the server's thread, for timers of skills and to pass results to it from other
    /// threads. It drops its work if the server could not be made, and after run().
    std::shared_ptr<skill::Executor> executor() const;

    /// Adds a skill made of functions; before run(). Its type is declared in the namespace of
    /// OwnServerOptions::types, unless metier's model has a type of that name.
    void offer(skill::SkillDescription description, skill::SkillFunctions functions,
               OfferOptions options = {});
    /// Adds a skill of a class of your own, such as a TypedSkill.
    /// \param skill not null
    void offer(std::unique_ptr<skill::Skill> skill, OfferOptions options = {});

    /// Serves until Ctrl-C or SIGTERM; prints "ready URL" once clients may connect. Then it brakes
    /// what moves, for at most 2 s, and ends the server and its skills; the kernel ends the program
    /// if that takes over 10 s. Once.
    /// \return exit status: 0 ended by a signal, or --help; 1 the server cannot be made, the port
    ///         is taken, or a skill is not possible; 2 the command line is wrong
    int run();

private:
    struct State;

    std::unique_ptr<State> state_;
};

}  // namespace metier::server
