#include "metier/cell/toml_file.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace metier::cell {

namespace {

constexpr std::string_view kText = "a text";
constexpr std::string_view kNumber = "a finite number";

}  // namespace

struct TomlFile::Impl {
    std::string name;
    std::string content;
    toml::table root;
    // Line numbers order the report as a reader goes through the file.
    std::multimap<toml::source_index, std::string> problems = {};
    std::vector<std::unique_ptr<const TomlTable::Impl>> tables = {};
    std::unordered_map<const toml::table*, const TomlTable::Impl*> views =
        {};  // views by their tables
    std::vector<std::unique_ptr<const TomlValue::Impl>> values = {};

    // Out of line: TomlTable::Impl is complete only below.
    Impl(std::string file_name, std::string_view text, toml::table table);
    ~Impl();
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    TomlTable open(const toml::table* table, std::string path);

    TomlValue openValue(const toml::node& node, std::string path);

    void note(const toml::source_region& where, std::string_view key, std::string_view why) {
        note(where.begin.line, key, why);
    }
    void note(toml::source_index line, std::string_view key, std::string_view why) {
        problems.emplace(line, fmt::format("{}:{}: {}: {}", name, line, key, why));
    }
};

struct TomlValue::Impl {
    TomlFile::Impl* file = nullptr;
    const toml::node* node = nullptr;
    std::string path;
};

struct TomlTable::Impl {
    TomlFile::Impl* file = nullptr;
    const toml::table* table = nullptr;
    std::string path;
    mutable std::set<std::string, std::less<>> asked = {};

    const toml::node* find(std::string_view key) const {
        asked.emplace(key);
        return table == nullptr ? nullptr : table->get(key);
    }

    std::string fullName(std::string_view key) const {
        return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
    }

    const toml::node* require(std::string_view key, std::string_view kind) const {
        const auto* node = find(key);
        if (node == nullptr && table != nullptr) {
            file->note(table->source(), fullName(key), fmt::format("missing; needs {}", kind));
        }
        return node;
    }

    template <typename T>
    T valueOf(const toml::node* node, std::string_view key, std::string_view kind) const {
        if (node == nullptr) {
            return T{};
        }
        if (const auto value = node->value<T>()) {
            return *value;
        }
        file->note(node->source(), fullName(key), fmt::format("is not {}", kind));
        return T{};
    }

    template <typename T>
    std::vector<T> valuesOf(std::string_view key, std::string_view kind) const {
        std::vector<T> values;
        const auto* node = require(key, kind);
        if (node == nullptr) {
            return values;
        }
        const auto* array = node->as_array();
        if (array == nullptr) {
            file->note(node->source(), fullName(key), fmt::format("is not {}", kind));
            return values;
        }
        for (const auto& element : *array) {
            values.push_back(valueOf<T>(&element, key, kind));
        }
        return values;
    }

    void reportUnknownKeys() const {
        if (table == nullptr) {
            return;
        }
        for (const auto& [key, node] : *table) {
            if (!asked.contains(key.str())) {
                file->note(key.source(), fullName(key.str()),
                           fmt::format("unknown key; known here: {}", fmt::join(asked, ", ")));
            }
        }
    }
};

TomlFile::Impl::Impl(std::string file_name, std::string_view text, toml::table table)
    : name(std::move(file_name)), content(text), root(std::move(table)) {}

TomlFile::Impl::~Impl() = default;

/// Opens the one view of a table. Each table has one, so that the keys read are known however often
/// it is opened.
TomlTable TomlFile::Impl::open(const toml::table* table, std::string path) {
    if (const auto known = views.find(table); known != views.end()) {
        return TomlTable(known->second);
    }
    tables.push_back(
        std::make_unique<TomlTable::Impl>(TomlTable::Impl{this, table, std::move(path)}));
    if (table != nullptr) {
        views.emplace(table, tables.back().get());
    }
    return TomlTable(tables.back().get());
}

TomlValue TomlFile::Impl::openValue(const toml::node& node, std::string path) {
    values.push_back(
        std::make_unique<TomlValue::Impl>(TomlValue::Impl{this, &node, std::move(path)}));
    return TomlValue(values.back().get());
}

std::optional<bool> TomlValue::flag() const {
    return impl_->node->value_exact<bool>();
}

std::optional<std::int64_t> TomlValue::integer() const {
    return impl_->node->value_exact<std::int64_t>();
}

std::optional<double> TomlValue::number() const {
    const auto number = impl_->node->is_number() ? impl_->node->value<double>() : std::nullopt;
    return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<std::string> TomlValue::text() const {
    return impl_->node->value_exact<std::string>();
}

bool TomlValue::isList() const {
    return impl_->node->is_array();
}

std::vector<TomlValue> TomlValue::items() const {
    std::vector<TomlValue> result;
    if (const auto* array = impl_->node->as_array()) {
        for (const auto& element : *array) {
            result.push_back(
                impl_->file->openValue(element, fmt::format("{}[{}]", impl_->path, result.size())));
        }
    }
    return result;
}

std::optional<TomlTable> TomlValue::table() const {
    const auto* table = impl_->node->as_table();
    return table == nullptr ? std::nullopt : std::optional(impl_->file->open(table, impl_->path));
}

std::uint32_t TomlValue::line() const {
    return impl_->node->source().begin.line;
}

void TomlValue::reject(std::string_view why) const {
    impl_->file->note(impl_->node->source(), impl_->path, why);
}

bool TomlTable::has(std::string_view key) const {
    return impl_->find(key) != nullptr;
}

std::vector<std::string> TomlTable::keys() const {
    std::vector<std::pair<std::pair<toml::source_index, toml::source_index>, std::string>> placed;
    if (impl_->table != nullptr) {
        for (const auto& [key, node] : *impl_->table) {
            const auto& begin = key.source().begin;
            placed.emplace_back(std::pair(begin.line, begin.column), std::string(key.str()));
        }
    }
    std::sort(placed.begin(), placed.end());
    std::vector<std::string> names;
    names.reserve(placed.size());
    for (auto& [place, name] : placed) {
        names.push_back(std::move(name));
    }
    return names;
}

std::optional<TomlValue> TomlTable::value(std::string_view key) const {
    const auto* node = impl_->find(key);
    return node == nullptr ? std::nullopt
                           : std::optional(impl_->file->openValue(*node, impl_->fullName(key)));
}

std::string TomlTable::text(std::string_view key) const {
    return impl_->valueOf<std::string>(impl_->require(key, kText), key, kText);
}

double TomlTable::number(std::string_view key) const {
    const auto value = impl_->valueOf<double>(impl_->require(key, kNumber), key, kNumber);
    if (!std::isfinite(value)) {
        reject(key, "is not a finite number");
        return 0.0;
    }
    return value;
}

std::vector<double> TomlTable::numbers(std::string_view key) const {
    auto values = impl_->valuesOf<double>(key, "a list of finite numbers");
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
        reject(key, "holds a number that is not finite");
        values.clear();
    }
    return values;
}

std::vector<std::string> TomlTable::texts(std::string_view key) const {
    return impl_->valuesOf<std::string>(key, "a list of texts");
}

TomlTable TomlTable::table(std::string_view key) const {
    const auto* node = impl_->require(key, "a table");
    const auto* found = node == nullptr ? nullptr : node->as_table();
    if (node != nullptr && found == nullptr) {
        reject(key, "is not a table");
    }
    return impl_->file->open(found, impl_->fullName(key));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
    std::vector<TomlTable> result;
    const auto* node = impl_->find(key);
    if (node == nullptr) {
        return result;
    }
    if (!node->is_array_of_tables()) {
        reject(key, fmt::format("is not a list of tables; write [[{}]]", impl_->fullName(key)));
        return result;
    }
    for (const auto& element : *node->as_array()) {
        const auto path = fmt::format("{}[{}]", impl_->fullName(key), result.size());
        result.push_back(impl_->file->open(element.as_table(), path));
    }
    return result;
}

std::string TomlTable::textOr(std::string_view key, std::string fallback) const {
    return has(key) ? text(key) : std::move(fallback);
}

std::optional<double> TomlTable::amount(std::string_view key, std::string_view unit) const {
    if (!has(key)) {
        return {};
    }
    const double value = number(key);
    if (value < 0) {
        reject(key, fmt::format("{} {} is under 0 {}", value, unit, unit));
    }
    return value;
}

double TomlTable::numberOr(std::string_view key, double fallback) const {
    return has(key) ? number(key) : fallback;
}

std::int64_t TomlTable::integerOr(std::string_view key, std::int64_t fallback, std::int64_t low,
                                  std::int64_t high) const {
    const auto* node = impl_->find(key);
    if (node == nullptr) {
        return fallback;
    }
    const auto value = node->value_exact<std::int64_t>();
    if (!value) {
        reject(key, "is not a whole number");
        return fallback;
    }
    if (*value < low || *value > high) {
        reject(key, fmt::format("{} is not within {} to {}", *value, low, high));
        return fallback;
    }
    return *value;
}

bool TomlTable::flagOr(std::string_view key, bool fallback) const {
    const auto* node = impl_->find(key);
    return node == nullptr ? fallback : impl_->valueOf<bool>(node, key, "true or false");
}

namespace {

/// \return nothing if a setting cannot have such a value
std::optional<Settings::Value> settingOf(const toml::node& node) {
    if (const auto number = node.value<double>()) {
        return std::isfinite(*number) ? std::optional<Settings::Value>(*number) : std::nullopt;
    }
    if (const auto flag = node.value<bool>()) {
        return *flag;
    }
    if (const auto text = node.value<std::string>()) {
        return *text;
    }
    const auto* array = node.as_array();
    if (array == nullptr) {
        return std::nullopt;
    }
    std::vector<double> numbers;
    for (const auto& element : *array) {
        const auto number = element.value<double>();
        if (!number || !std::isfinite(*number)) {
            return std::nullopt;
        }
        numbers.push_back(*number);
    }
    return numbers;
}

}  // namespace

Settings TomlTable::settings(std::initializer_list<std::string_view> taken) const {
    std::map<std::string, Settings::Value> values;
    if (impl_->table == nullptr) {
        return {};
    }
    const auto take = [&](const std::string& name, const std::string& below, const toml::node& node,
                          std::string_view why) {
        if (auto value = settingOf(node)) {
            values.emplace(name + below, std::move(*value));
        } else {
            reject(name, why);
        }
    };
    for (const auto& [key, node] : *impl_->table) {
        const std::string name(key.str());
        if (std::find(taken.begin(), taken.end(), name) != taken.end()) {
            continue;
        }
        impl_->asked.insert(name);
        const auto* inner = node.as_table();
        if (inner == nullptr) {
            take(name, "", node, "is no finite number, text, flag or list of finite numbers");
            continue;
        }
        for (const auto& [inner_key, inner_node] : *inner) {
            take(name, "." + std::string(inner_key.str()), inner_node,
                 "holds a value that is no number, text, flag or list of numbers");
        }
    }
    return Settings(fmt::format("{}: {}", place(), impl_->path), std::move(values));
}

void TomlTable::reject(std::string_view key, std::string_view why) const {
    const auto* node = impl_->find(key);
    if (node == nullptr && impl_->table == nullptr) {
        return;  // the missing table is noted already
    }
    impl_->file->note(node == nullptr ? impl_->table->source() : node->source(),
                      impl_->fullName(key), why);
}

std::string TomlTable::place() const {
    return fmt::format("{}:{}", impl_->file->name, line());
}

std::uint32_t TomlTable::line() const {
    return impl_->table == nullptr ? 1 : impl_->table->source().begin.line;
}

namespace {

/// toml++ goes as deep as a key has dots, and a key is within a line.
Result<void> checkLines(std::string_view text, const std::string& name) {
    constexpr std::size_t kLongestLine = 20'000;
    for (std::size_t line = 1; !text.empty(); ++line) {
        const auto length = std::min(text.find('\n'), text.size());
        if (length > kLongestLine) {
            return fail(Errc::invalid_argument,
                        fmt::format("{}:{}: the line has {} characters, limit {}", name, line,
                                    length, kLongestLine));
        }
        text.remove_prefix(std::min(length + 1, text.size()));
    }
    return {};
}

}  // namespace

Result<TomlFile> TomlFile::load(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
        return fail(Errc::not_found, fmt::format("{}: no such file", path.string()));
    }
    std::ifstream stream(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) {
        return fail(Errc::not_found, fmt::format("{}: cannot be read", path.string()));
    }
    return parse(text, path.string());
}

Result<TomlFile> TomlFile::parse(std::string_view text, std::string name) {
    METIER_TRY(checkLines(text, name));
    try {
        return TomlFile(std::make_unique<Impl>(name, text, toml::parse(text)));
    } catch (const toml::parse_error& problem) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}:{}:{}: {}", name, problem.source().begin.line,
                                problem.source().begin.column, problem.description()));
    }
}

TomlFile::TomlFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TomlFile::TomlFile(TomlFile&&) noexcept = default;
TomlFile& TomlFile::operator=(TomlFile&&) noexcept = default;
TomlFile::~TomlFile() = default;

TomlTable TomlFile::root() const {
    return impl_->open(&impl_->root, "");
}

const std::string& TomlFile::content() const noexcept {
    return impl_->content;
}

void TomlFile::note(std::uint32_t line, std::string_view what, std::string_view why) const {
    impl_->note(line, what, why);
}

Result<void> TomlFile::finish() const {
    for (const auto& table : impl_->tables) {
        table->reportUnknownKeys();
    }
    if (impl_->problems.empty()) {
        return {};
    }
    std::string text;
    for (const auto& [line, problem] : impl_->problems) {
        text += (text.empty() ? "" : "\n") + problem;
    }
    return fail(Errc::invalid_argument, std::move(text));
}

}  // namespace metier::cell
