#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "xml_file.hpp"

namespace metier::robot_files {

/// A group of an SRDF file that is a chain from one link to another.
struct ChainGroup {
    std::string name;
    std::string base;
    std::string tip;
};

/// Content of an SRDF file that metier uses: chains, named joint positions, pairs of links that are
/// not compared for self-collision.
class Semantics {
public:
    /// Notes errors in the file.
    static Semantics read(XmlFile& file);

    const std::vector<ChainGroup>& groups() const noexcept { return groups_; }
    /// Positions of joints by their names [rad], of the group state of that name; the first if
    /// several groups have one. Empty without it.
    const std::map<std::string, double>& state(const std::string& name) const;
    /// Whether two links, by their names, are not compared.
    bool isDisabled(const std::string& first, const std::string& second) const;
    /// Number of pairs that the file names.
    std::size_t disabledCount() const noexcept { return disabled_.size(); }

private:
    using Pair = std::pair<std::string, std::string>;

    void readGroup(pugi::xml_node element);
    void readState(pugi::xml_node element);
    static Pair readPair(XmlFile& file, pugi::xml_node element);

    std::vector<ChainGroup> groups_;
    std::map<std::string, std::map<std::string, double>> states_;
    std::set<Pair> disabled_;
    std::set<Pair> enabled_;
    std::set<std::string> disabled_by_default_;
};

}  // namespace metier::robot_files
