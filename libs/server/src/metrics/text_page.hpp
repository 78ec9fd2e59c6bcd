#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/base/histogram.hpp"

namespace metier::server {

enum class MetricKind { counter, gauge, histogram };

/// By name; values may be any UTF-8 text.
using Labels = std::vector<std::pair<std::string, std::string>>;

/// Figures in the text format of Prometheus, version 0.0.4
/// (https://prometheus.io/docs/instrumenting/exposition_formats/).
///
/// A family comes first, then all its figures. Threading: one thread.
class TextPage {
public:
    static constexpr const char* kContentType = "text/plain; version=0.0.4; charset=utf-8";

    /// \param name [a-zA-Z_:][a-zA-Z0-9_:]*, once on a page; that of a counter ends in _total
    void family(std::string_view name, MetricKind kind, std::string_view help);
    /// A family of one figure without labels. Parameters as family() and add() take them.
    template <typename Value>
    void figure(std::string_view name, MetricKind kind, std::string_view help, const Value& value) {
        family(name, kind, help);
        add({}, value);
    }
    /// A figure of the family, which is no histogram.
    void add(const Labels& labels, double value);
    void add(const Labels& labels, std::uint64_t value);
    /// A figure of the family, which is a histogram [s].
    void add(const Labels& labels, const TimeHistogram::Snapshot& histogram);

    const std::string& text() const noexcept { return text_; }

private:
    void line(std::string_view suffix, const Labels& labels, std::string_view value);

    std::string family_;
    std::string text_;
};

}  // namespace metier::server
