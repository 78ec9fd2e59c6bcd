#include "printable.hpp"

#include <spdlog/pattern_formatter.h>

#include <algorithm>
#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::app {
namespace {

std::string byLine(std::string_view text, std::string_view between) {
    std::string result;
    while (true) {
        const auto end = std::min(text.find('\n'), text.size());
        result += opcua::sanitise(text.substr(0, end));
        if (end == text.size()) {
            return result;
        }
        result += between;
        text.remove_prefix(end + 1);
    }
}

class PrintableFormatter final : public spdlog::formatter {
public:
    explicit PrintableFormatter(std::unique_ptr<spdlog::formatter> inner)
        : inner_(std::move(inner)) {}

    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& into) override {
        const auto text = byLine({message.payload.data(), message.payload.size()}, "\n    ");
        auto printed = message;
        printed.payload = text;
        inner_->format(printed, into);
        // Position of the level in the line, for its colour.
        message.color_range_start = printed.color_range_start;
        message.color_range_end = printed.color_range_end;
    }
    std::unique_ptr<spdlog::formatter> clone() const override {
        return std::make_unique<PrintableFormatter>(inner_->clone());
    }

private:
    std::unique_ptr<spdlog::formatter> inner_;
};

}  // namespace

std::string printable(std::string_view text) {
    return byLine(text, "\n");
}

std::unique_ptr<spdlog::formatter> printableLog(const std::string& pattern) {
    return std::make_unique<PrintableFormatter>(
        std::make_unique<spdlog::pattern_formatter>(pattern));
}

}  // namespace metier::app
