#include "toml_reader.hpp"

#include <cmath>
#include <numbers>

namespace metier::motion {

void TomlReader::refuse(const toml::node& node, std::string_view key, std::string_view what) {
    if (!error_) {
        error_ = Error{Errc::invalid_argument,
                       fmt::format("{}:{}: {}: {}", file_, node.source().begin.line, key, what)};
    }
}

void TomlReader::Table::refuse(std::string_view key, std::string_view what) {
    const toml::node* node = table_->get(key);
    reader_->refuse(node != nullptr ? *node : *table_, path_ + std::string(key), what);
}

const toml::node* TomlReader::Table::find(std::string_view key) {
    asked_.emplace(key);
    const toml::node* node = table_->get(key);
    if (node == nullptr) {
        refuse(key, "missing");
    }
    return node;
}

std::string TomlReader::Table::text(std::string_view key) {
    const toml::node* node = find(key);
    const auto value = node != nullptr ? node->value<std::string>() : std::nullopt;
    if (node != nullptr && !value) {
        refuse(key, "not a text");
    }
    return value.value_or("");
}

double TomlReader::Table::number(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) {
        return 0;
    }
    const auto value = node->is_number() ? node->value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) {
        refuse(key, "not a finite number");
        return 0;
    }
    return *value;
}

double TomlReader::Table::number(std::string_view key, double otherwise) {
    return has(key) ? number(key) : otherwise;
}

double TomlReader::Table::positive(std::string_view key) {
    const double value = number(key);
    if (value <= 0) {
        refuse(key, fmt::format("{} is not over 0", value));
    }
    return value;
}

std::size_t TomlReader::Table::index(std::string_view key, std::size_t end) {
    const double value = number(key);
    if (value < 0 || value >= static_cast<double>(end) || value != std::floor(value)) {
        refuse(key, fmt::format("{} is not one of 0 to {}", value, end - 1));
        return 0;
    }
    return static_cast<std::size_t>(value);
}

std::vector<double> TomlReader::Table::numbers(std::string_view key, std::size_t count) {
    std::vector<double> values;
    const toml::node* node = find(key);
    if (node == nullptr) {
        return std::vector<double>(count);
    }
    if (const toml::array* array = node->as_array()) {
        for (const toml::node& element : *array) {
            values.push_back(element.is_number() ? element.value_or(std::nan("")) : std::nan(""));
        }
    }
    bool finite = true;
    for (const double value : values) {
        finite = finite && std::isfinite(value);
    }
    if (values.size() != count || !finite) {
        refuse(key, fmt::format("not {} finite numbers", count));
        values.assign(count, 0.0);
    }
    return values;
}

Eigen::Vector3d TomlReader::Table::vector(std::string_view key) {
    const std::vector<double> values = numbers(key, 3);
    return {values[0], values[1], values[2]};
}

TomlReader::Table::Unit TomlReader::Table::angleUnit(std::string_view key) {
    std::string degrees = std::string(key) + "_deg";
    if (!has(degrees)) {
        return {std::string(key)};
    }
    if (has(key)) {
        refuse(key, "given twice, in rad and in degrees");
    }
    return {std::move(degrees), std::numbers::pi, 180.0};
}

double TomlReader::Table::angle(std::string_view key) {
    const Unit unit = angleUnit(key);
    return number(unit.key) * unit.factor / unit.divisor;
}

double TomlReader::Table::angle(std::string_view key, double otherwise) {
    return has(key) || has(std::string(key) + "_deg") ? angle(key) : otherwise;
}

std::vector<double> TomlReader::Table::angles(std::string_view key, std::size_t count) {
    const Unit unit = angleUnit(key);
    std::vector<double> values = numbers(unit.key, count);
    for (double& value : values) {
        value = value * unit.factor / unit.divisor;
    }
    return values;
}

TomlReader::Table TomlReader::Table::table(std::string_view key) {
    static const toml::table empty;
    const toml::node* node = find(key);
    const toml::table* table = node != nullptr ? node->as_table() : nullptr;
    if (node != nullptr && table == nullptr) {
        refuse(key, "not a table");
    }
    return {*reader_, table != nullptr ? *table : empty, path_ + std::string(key) + "."};
}

std::vector<TomlReader::Table> TomlReader::Table::tables(std::string_view key) {
    std::vector<Table> result;
    asked_.emplace(key);
    const toml::node* node = table_->get(key);
    const toml::array* array = node != nullptr ? node->as_array() : nullptr;
    if (node != nullptr && array == nullptr) {
        refuse(key, fmt::format("not a list of tables: write [[{}]]", key));
    }
    for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
        if (const toml::table* table = array->get(i)->as_table()) {
            result.emplace_back(*reader_, *table, fmt::format("{}{}[{}].", path_, key, i + 1));
        } else {
            refuse(key, "has an element that is not a table");
        }
    }
    return result;
}

void TomlReader::Table::refuseOtherKeys() {
    for (const auto& [key, node] : *table_) {
        if (asked_.find(key.str()) == asked_.end()) {
            reader_->refuse(node, path_ + std::string(key.str()), "unknown key");
        }
    }
}

}  // namespace metier::motion
