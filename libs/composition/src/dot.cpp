#include "metier/composition/dot.hpp"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "scope.hpp"

namespace metier::composition {

namespace {

std::string inQuotes(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            result += '\\';
        }
        result += c == '\n' ? ' ' : c;
    }
    return result + "\"";
}

struct Printer {
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(const std::string& text) const { return fmt::format("'{}'", text); }
    template <typename T>
    std::string operator()(const std::vector<T>& list) const {
        return fmt::format("[{} values]", list.size());
    }
    template <typename T>
    std::string operator()(T number) const {
        return fmt::format("{}", number);
    }
};

std::string textOf(const Binding& binding) {
    std::string text;
    if (const auto* reference = std::get_if<Reference>(&binding.source)) {
        text = nameOf(*reference);
    } else if (const auto* literal = std::get_if<Literal>(&binding.source)) {
        text = std::visit(Printer{}, *literal);
    } else {
        text = "[...]";
    }
    return binding.shift.empty() ? text : text + " shifted";
}

std::string textOf(const Condition& condition) {
    switch (condition.kind) {
        case Condition::Kind::is:
            return fmt::format("{} is {}", nameOf(condition.subject), textOf(condition.operand));
        case Condition::Kind::less:
            return fmt::format("{} < {}", nameOf(condition.subject), textOf(condition.operand));
        case Condition::Kind::greater:
            return fmt::format("{} > {}", nameOf(condition.subject), textOf(condition.operand));
        case Condition::Kind::negation:
            return fmt::format("not ({})", textOf(condition.parts.front()));
        default:
            break;
    }
    std::string text;
    for (const auto& part : condition.parts) {
        const auto* word = condition.kind == Condition::Kind::all ? " and " : " or ";
        text += (text.empty() ? "" : word) + textOf(part);
    }
    return text;
}

/// Title of the frame around the steps of a step.
std::string titleOf(const Step& step) {
    std::string title = step.name;
    switch (step.kind) {
        case StepKind::parallel:
            title += step.wait_for == WaitFor::all ? ": all at the same time"
                                                   : ": at the same time, until one succeeds";
            break;
        case StepKind::fallback:
            title += ": the first that succeeds";
            break;
        case StepKind::choice:
            title += ": if " + textOf(*step.condition);
            break;
        case StepKind::loop:
            title += ": repeat";
            title += step.times ? " " + textOf(*step.times) + " times" : std::string();
            title += step.condition ? " while " + textOf(*step.condition) : std::string();
            title += step.until ? " until " + textOf(*step.until) : std::string();
            title += step.at_most ? fmt::format(", at most {}", *step.at_most) : std::string();
            break;
        default:
            break;
    }
    if (step.retry) {
        title += fmt::format(", {} more on failure", step.retry->times);
    }
    if (step.timeout) {
        title += fmt::format(", within {} s", std::chrono::duration<double>(*step.timeout).count());
    }
    return title;
}

/// The nodes that an arrow into a step leads to, and those that arrows out of it come from.
struct Ends {
    std::vector<std::string> in;
    std::vector<std::string> out;
};

class Drawing {
public:
    explicit Drawing(const Definition& definition) : definition_(definition) {
        for (const auto& use : definition.uses) {
            types_[use.alias] = use.type;
        }
    }

    std::string draw() && {
        text_ = fmt::format(
            "digraph {} {{\n  label={};\n  labelloc=t;\n  fontname=\"sans-serif\";\n"
            "  node [shape=box, style=rounded, fontname=\"sans-serif\"];\n"
            "  edge [fontname=\"sans-serif\"];\n  begin [shape=circle, label=\"\"];\n"
            "  end [shape=doublecircle, label=\"\"];\n",
            inQuotes(definition_.name), inQuotes(definition_.name));
        const auto ends = chain(definition_.root.steps, 1);
        connect({"begin"}, ends.in, "");
        connect(ends.out, {"end"}, "");
        return text_ + "}\n";
    }

private:
    void line(std::size_t depth, const std::string& text) {
        text_ += std::string(2 * depth, ' ') + text + "\n";
    }

    void connect(const std::vector<std::string>& from, const std::vector<std::string>& to,
                 std::string_view attributes) {
        for (const auto& source : from) {
            for (const auto& target : to) {
                text_ += fmt::format("  {} -> {}{};\n", source, target, attributes);
            }
        }
    }

    Ends chain(const std::vector<Step>& steps, std::size_t depth) {
        Ends whole;
        for (const auto& step : steps) {
            auto ends = draw(step, depth);
            if (whole.in.empty()) {
                whole.in = ends.in;
            } else {
                connect(whole.out, ends.in, "");
            }
            whole.out = std::move(ends.out);
        }
        return whole;
    }

    Ends draw(const Step& step, std::size_t depth) {
        if (step.kind == StepKind::call) {
            const auto node = inQuotes(step.name);
            line(depth, fmt::format("{} [label={}];", node,
                                    inQuotes(titleOf(step) + " — " + types_[step.use])));
            return {{node}, {node}};
        }
        if (step.kind == StepKind::failure) {
            const auto node = inQuotes(step.name);
            line(depth, fmt::format("{} [shape=octagon, label={}];", node,
                                    inQuotes("fails: " + step.text)));
            return {{node}, {}};
        }
        line(depth, fmt::format("subgraph {} {{", inQuotes("cluster_" + step.name)));
        line(depth + 1, fmt::format("label={};", inQuotes(titleOf(step))));
        auto ends = drawWithin(step, depth + 1);
        line(depth, "}");
        return ends;
    }

    Ends drawWithin(const Step& step, std::size_t depth) {
        switch (step.kind) {
            case StepKind::parallel:
                return drawBranches(step.steps, depth);
            case StepKind::fallback:
                return drawFallback(step, depth);
            case StepKind::choice:
                return drawChoice(step, depth);
            case StepKind::loop: {
                auto ends = chain(step.steps, depth);
                connect(ends.out, ends.in, " [constraint=false, label=\"again\"]");
                return ends;
            }
            default:
                return chain(step.steps, depth);
        }
    }

    Ends drawBranches(const std::vector<Step>& steps, std::size_t depth) {
        Ends whole;
        for (const auto& step : steps) {
            const auto ends = draw(step, depth);
            whole.in.insert(whole.in.end(), ends.in.begin(), ends.in.end());
            whole.out.insert(whole.out.end(), ends.out.begin(), ends.out.end());
        }
        return whole;
    }

    Ends drawFallback(const Step& step, std::size_t depth) {
        Ends whole;
        std::vector<std::string> before;
        for (const auto& alternative : step.steps) {
            const auto ends = draw(alternative, depth);
            if (whole.in.empty()) {
                whole.in = ends.in;
            } else {
                connect(before, ends.in, " [style=dashed, label=\"failed\"]");
            }
            before = ends.out;
            whole.out.insert(whole.out.end(), ends.out.begin(), ends.out.end());
        }
        return whole;
    }

    Ends drawChoice(const Step& step, std::size_t depth) {
        const auto node = inQuotes(step.name);
        line(depth,
             fmt::format("{} [shape=diamond, label={}];", node, inQuotes(textOf(*step.condition))));
        Ends whole{{node}, {}};
        for (const auto& [steps, label] :
             {std::pair(&step.steps, "yes"), std::pair(&step.otherwise, "no")}) {
            const auto ends = chain(*steps, depth);
            connect({node}, ends.in, fmt::format(" [label=\"{}\"]", label));
            whole.out.insert(whole.out.end(), ends.out.begin(), ends.out.end());
        }
        if (step.otherwise.empty()) {
            whole.out.push_back(node);
        }
        return whole;
    }

    const Definition& definition_;
    std::map<std::string, std::string> types_;  // of the used skills, by alias
    std::string text_;
};

}  // namespace

std::string toDot(const Definition& definition) {
    return Drawing(definition).draw();
}

}  // namespace metier::composition
