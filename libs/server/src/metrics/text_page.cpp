#include "metrics/text_page.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace metier::server {
namespace {

constexpr std::array kTypeNames{"counter", "gauge", "histogram"};  // by MetricKind

std::string escaped(std::string_view text, std::string_view also) {
    std::string result;
    for (const char letter : text) {
        if (letter == '\n') {
            result += "\\n";
        } else if (letter == '\\' || also.find(letter) != std::string_view::npos) {
            result += '\\';
            result += letter;
        } else {
            result += letter;
        }
    }
    return result;
}

std::string textOf(double value) {
    return std::isnan(value)   ? "NaN"
           : std::isinf(value) ? (value > 0 ? "+Inf" : "-Inf")
                               : fmt::format("{}", value);
}

}  // namespace

void TextPage::family(std::string_view name, MetricKind kind, std::string_view help) {
    family_ = name;
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, escaped(help, ""), name,
                         kTypeNames.at(static_cast<std::size_t>(kind)));
}

void TextPage::add(const Labels& labels, double value) {
    line("", labels, textOf(value));
}

void TextPage::add(const Labels& labels, std::uint64_t value) {
    line("", labels, fmt::format("{}", value));
}

void TextPage::add(const Labels& labels, const TimeHistogram::Snapshot& histogram) {
    auto of_bucket = labels;
    of_bucket.emplace_back("le", "");
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < TimeHistogram::kBuckets; ++i) {
        count += histogram.counts.at(i);
        of_bucket.back().second =
            i < TimeHistogram::kBounds.size() ? textOf(TimeHistogram::kBounds.at(i)) : "+Inf";
        line("_bucket", of_bucket, fmt::format("{}", count));
    }
    line("_sum", labels, textOf(histogram.sum));
    line("_count", labels, fmt::format("{}", count));
}

void TextPage::line(std::string_view suffix, const Labels& labels, std::string_view value) {
    text_ += family_;
    text_ += suffix;
    char before = '{';
    for (const auto& [name, label] : labels) {
        text_ += fmt::format("{}{}=\"{}\"", before, name, escaped(label, "\""));
        before = ',';
    }
    text_ += labels.empty() ? " " : "} ";
    text_ += value;
    text_ += '\n';
}

}  // namespace metier::server
