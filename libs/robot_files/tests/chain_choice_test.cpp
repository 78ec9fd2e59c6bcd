// Which part of a URDF tree becomes a model.
#include "chain_choice.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "metier/motion/joint_vector.hpp"

namespace metier::robot_files {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A tree that is written link by link.
class Tree {
public:
    explicit Tree(const std::string& root) { addLink(root); }

    Tree& joint(const std::string& parent, const std::string& child,
                const std::string& type = "revolute", const std::string& more = "") {
        addLink(child);
        text_ += fmt::format(
            R"(<joint name="to_{1}" type="{2}"><parent link="{0}"/><child link="{1}"/>{3}</joint>)",
            parent, child, type, more);
        return *this;
    }
    Tree& root(const std::string& name) {
        addLink(name);
        return *this;
    }
    /// The axes of the chosen chain and its tip, or the errors.
    std::string choose(const ChainEnds& ends = {}) const {
        auto file =
            XmlFile::parse(fmt::format("<robot name=\"tree\">{}</robot>", text_), "tree.urdf")
                .value();
        const auto tree = RobotTree::read(file);
        const auto choice = chooseChain(file, tree, ends);
        if (!choice) {
            return file.finish().error().message;
        }
        std::string chosen = tree.links()[choice->base].name;
        for (const auto joint : choice->axes) {
            chosen += " " + tree.joints()[joint].name;
        }
        return fmt::format("{} -> {} ({})", chosen, tree.links()[choice->tip].name,
                           choice->why_this_tip);
    }

private:
    void addLink(const std::string& name) { text_ += fmt::format("<link name=\"{}\"/>\n", name); }

    std::string text_;
};

TEST(ChosenPart, IsTheOnlyChainUpToItsLastLink) {
    const auto tree = Tree("base").joint("base", "a").joint("a", "b").joint("b", "end", "fixed");
    EXPECT_EQ(tree.choose(), "base to_a to_b -> end (the last link of the chain)");
}

TEST(ChosenPart, EndsAtTool0BeforeAFlangeBeforeTheLastMovedLink) {
    auto tree = Tree("base").joint("base", "a");
    EXPECT_EQ(tree.choose(), "base to_a -> a (the last link of the chain)");
    tree.joint("a", "camera", "fixed").joint("a", "light", "fixed");
    EXPECT_EQ(tree.choose(), "base to_a -> a (the last link that an axis moves)");
    tree.joint("a", "flange", "fixed");
    EXPECT_EQ(tree.choose(), "base to_a -> flange (by its name)");
    tree.joint("flange", "tool0", "fixed");
    EXPECT_EQ(tree.choose(), "base to_a -> tool0 (ROS' name of a controller's flange)");
}

TEST(ChosenPart, LeavesOutAFlangeOfAnotherBranch) {
    const auto tree = Tree("base").joint("base", "flange", "fixed").joint("base", "a");
    EXPECT_EQ(tree.choose(), "base to_a -> a (the last link of the chain)");
}

TEST(ChosenPart, IsNoGripperWhoseFingersSlide) {
    const auto tree = Tree("base")
                          .joint("base", "a")
                          .joint("a", "left", "prismatic")
                          .joint("a", "right", "prismatic", "<mimic joint=\"to_left\"/>");
    EXPECT_THAT(tree.choose({.base = "", .tip = "left"}),
                AllOf(HasSubstr("its type is prismatic"), HasSubstr("--tip \"a\"")));
    EXPECT_EQ(tree.choose({.base = "", .tip = "a"}), "base to_a -> a ()");
}

TEST(ChosenPart, IsAskedForWhereTwoChainsCouldBeIt) {
    const auto tree =
        Tree("torso").joint("torso", "left").joint("torso", "right").joint("right", "hand");
    EXPECT_THAT(tree.choose(), AllOf(HasSubstr("end of one of 2 chains (1 axes)"),
                                     HasSubstr("end of one of 2 chains (2 axes)"),
                                     HasSubstr("choose with --tip \"hand\"")));
    EXPECT_EQ(tree.choose({.base = "", .tip = "left"}), "torso to_left -> left ()");
}

TEST(ChosenPart, BeginsAtTheBaseThatIsAskedFor) {
    const auto tree = Tree("world").joint("world", "base", "fixed").joint("base", "a");
    EXPECT_EQ(tree.choose({.base = "base", .tip = ""}),
              "base to_a -> a (the last link of the chain)");
    EXPECT_THAT(tree.choose({.base = "a", .tip = "base"}),
                HasSubstr("it is not behind the base link \"a\""));
    EXPECT_THAT(tree.choose({.base = "base", .tip = "base"}),
                HasSubstr("no joint turns between it and the base link \"base\""));
}

TEST(ChosenPart, NeedsABaseWhereTwoTreesAre) {
    const auto tree = Tree("one").joint("one", "a").root("two");
    EXPECT_THAT(tree.choose(),
                HasSubstr("one of 2 links without a parent: choose one with --base"));
    EXPECT_EQ(tree.choose({.base = "one", .tip = ""}),
              "one to_a -> a (the last link of the chain)");
    EXPECT_THAT(tree.choose({.base = "two", .tip = ""}),
                HasSubstr("no joint behind this link turns"));
}

TEST(ChosenPart, NamesTheFirstAxisThatIsTooMany) {
    Tree tree("link0");
    for (std::size_t i = 1; i <= motion::kMaxAxes + 1; ++i) {
        tree.joint(fmt::format("link{}", i - 1), fmt::format("link{}", i));
    }
    const auto last = fmt::format("link{}", motion::kMaxAxes + 1);
    EXPECT_THAT(tree.choose({.base = "", .tip = last}),
                AllOf(HasSubstr(fmt::format("<joint name=\"to_{}\"", last)),
                      HasSubstr(fmt::format("axis {0} of {0}, at most {1}", motion::kMaxAxes + 1,
                                            motion::kMaxAxes))));
}

TEST(ChosenPart, ListsAtMostTwelveLinksThatAreThere) {
    Tree tree("link0");
    for (int i = 1; i < 13; ++i) {
        tree.joint(fmt::format("link{}", i - 1), fmt::format("link{}", i), "fixed");
    }
    EXPECT_THAT(tree.choose({.base = "links", .tip = ""}),
                AllOf(HasSubstr("--base: no link \"links\"; there are: link0, link1, "),
                      HasSubstr("link11, ...")));
}

}  // namespace
}  // namespace metier::robot_files
