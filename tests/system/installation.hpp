#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/opcua/security.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {

/// `metier` as on a machine of its own: with a security folder, which is empty at first.
class Installation {
public:
    /// \param name of the folder, below that of the running test
    explicit Installation(const std::string& name);

    const std::filesystem::path& folder() const noexcept { return folder_; }
    std::vector<std::string> command(const std::vector<std::string>& arguments) const;
    /// \param password for METIER_PASSWORD; empty: not set
    Finished run(const std::vector<std::string>& arguments, const std::string& password = "") const;
    /// `metier serve` of one of the simulated cell. \param port 0: a free one
    ServerProcess serve(const std::string& server, const std::string& port = "0") const;
    /// Options for clients of this process with the command's identity, which is made first if it
    /// does not exist.
    opcua::ClientOptions asCommand() const;
    /// The thumbprint of an application of this installation.
    std::string thumbprintOf(const std::string& application) const;

private:
    std::filesystem::path folder_;
};

}  // namespace metier::system_tests
