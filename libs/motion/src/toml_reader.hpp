#pragma once

#include <toml++/toml.h>
#include <Eigen/Core>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::motion {

/// Reads values of a TOML file and remembers the first thing that is wrong, as file:line and key.
/// After an error the values read are meaningless and error() says why.
class TomlReader {
public:
    /// One table of the file; `path` is how errors name it. Every key must be asked for.
    class Table {
    public:
        Table(TomlReader& reader, const toml::table& table, std::string path)
            : reader_(&reader), table_(&table), path_(std::move(path)) {}

        std::string text(std::string_view key);
        double number(std::string_view key);
        double number(std::string_view key, double otherwise);
        double positive(std::string_view key);
        std::size_t index(std::string_view key, std::size_t end);
        std::vector<double> numbers(std::string_view key, std::size_t count);
        Eigen::Vector3d vector(std::string_view key);
        /// `key` in rad or `key`_deg in degrees: one of both.
        double angle(std::string_view key);
        double angle(std::string_view key, double otherwise);
        std::vector<double> angles(std::string_view key, std::size_t count);

        bool has(std::string_view key) const { return table_->contains(key); }
        Table table(std::string_view key);
        std::vector<Table> tables(std::string_view key);
        /// Refuses what nobody asked for: a misspelt key would be without effect.
        void refuseOtherKeys();
        void refuse(std::string_view key, std::string_view what);

    private:
        const toml::node* find(std::string_view key);
        /// The key as it stands in the file and what its values are multiplied with.
        struct Unit {
            std::string key;
            double factor = 1;
            double divisor = 1;
        };
        Unit angleUnit(std::string_view key);

        TomlReader* reader_;
        const toml::table* table_;
        std::string path_;
        std::set<std::string, std::less<>> asked_;
    };

    explicit TomlReader(std::string file) : file_(std::move(file)) {}
    const std::optional<Error>& error() const { return error_; }
    void refuse(const toml::node& node, std::string_view key, std::string_view what);

private:
    std::string file_;
    std::optional<Error> error_;
};

}  // namespace metier::motion
