#include "nodesets/load_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

class LoadOrder {
public:
    LoadOrder(const std::vector<NodesetFile>& files, const IsCompiledIn& is_compiled_in)
        : files_(files), is_compiled_in_(is_compiled_in) {}

    Result<std::vector<const NodesetFile*>> find() {
        for (const auto& file : files_) {
            noteModels(file);
        }
        for (const auto& file : files_) {
            visit(file);
        }
        if (!problems_.empty()) {
            return fail(Errc::invalid_argument, fmt::format("{}", fmt::join(problems_, "\n")));
        }
        return order_;
    }

private:
    enum class Mark { open, done };

    bool isNeeded(const NodesetFile& file) const {
        return std::any_of(file.models().begin(), file.models().end(),
                           [&](const auto& model) { return !is_compiled_in_(model.uri); });
    }

    void noteModels(const NodesetFile& file) {
        for (const auto& model : file.models()) {
            const auto [other, is_new] = holders_.emplace(model.uri, &file);
            if (!is_new) {
                problems_.push_back(file.problem(
                    model.element, fmt::format("the model {} is in {}, too", sanitise(model.uri),
                                               other->second->name())));
            }
        }
    }

    void visit(const NodesetFile& file) {
        if (marks_.contains(&file) || !isNeeded(file)) {
            return;
        }
        marks_[&file] = Mark::open;
        for (const auto& model : file.models()) {
            way_.push_back(model.uri);
            for (const auto& required : model.required) {
                require(file, required);
            }
            way_.pop_back();
        }
        marks_[&file] = Mark::done;
        order_.push_back(&file);
    }

    void require(const NodesetFile& file, const RequiredModel& required) {
        if (is_compiled_in_(required.uri)) {
            return;
        }
        const auto holder = holders_.find(required.uri);
        if (holder == holders_.end()) {
            problems_.push_back(file.problem(
                required.element,
                fmt::format("the required model {} is neither in a listed file nor compiled in",
                            sanitise(required.uri))));
        } else if (const auto mark = marks_.find(holder->second);
                   mark == marks_.end() || mark->second == Mark::done) {
            visit(*holder->second);
        } else if (holder->second != &file) {
            problems_.push_back(file.problem(
                required.element,
                fmt::format("models require each other: {} -> {}",
                            fmt::join(wayFrom(required.uri), " -> "), sanitise(required.uri))));
        }
    }

    /// The part of the way that leads back to a model.
    std::vector<std::string> wayFrom(const std::string& uri) const {
        std::vector<std::string> names;
        for (auto each = std::find(way_.begin(), way_.end(), uri); each != way_.end(); ++each) {
            names.push_back(sanitise(*each));
        }
        return names;
    }

    const std::vector<NodesetFile>& files_;
    const IsCompiledIn& is_compiled_in_;
    std::map<std::string, const NodesetFile*> holders_;
    std::map<const NodesetFile*, Mark> marks_;
    std::vector<std::string> way_;
    std::vector<const NodesetFile*> order_;
    std::vector<std::string> problems_;
};

}  // namespace

Result<std::vector<const NodesetFile*>> inLoadOrder(const std::vector<NodesetFile>& files,
                                                    const IsCompiledIn& is_compiled_in) {
    return LoadOrder(files, is_compiled_in).find();
}

}  // namespace metier::opcua
