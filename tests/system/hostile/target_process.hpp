#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "metier/link/child_process.hpp"

namespace metier::hostile {

/// The server that is attacked, a process of its own; it ends with this object.
class TargetProcess {
public:
    /// \param folder of makeIdentities(): it is closed; empty: an open one
    /// Throws unless it serves within a minute.
    explicit TargetProcess(const std::string& folder = {});

    const std::string& url() const { return url_; }
    std::uint16_t port() const;
    bool lives() { return process_.running(); }
    std::size_t residentKilobytes() const;
    std::size_t descriptors() const;

private:
    std::string procFolder() const;

    link::ChildProcess process_;
    std::string url_;
};

}  // namespace metier::hostile
