#include "tools/scene/looks.h"

#include "base/read_file.h"
#include "json/json_text.h"
#include "json/known_names.h"
#include "tools/cli/command.h"
#include "tools/creatures/creature_math.h"
#include "tools/scene/look_choice.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace throng::tools {
namespace {

using creature::Random;
using Color = std::array<float, 3>;

constexpr uint32_t kOutfits = 256;  // drawn at random from all combinations
constexpr float kMaxFactor = 1000;  // of SectionLook::color

float linear_of(uint32_t srgb) {
    const double encoded = srgb / 255.0;
    return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

Color read_color(const JsonView& value) {
    const std::string& text = value.as_string();
    const bool is_hex = text.size() == 7 && text[0] == '#' &&
                        text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    if (!is_hex) value.fail("must be a colour like \"#c03a2b\", but is '", printable(text), "'");
    const auto rgb = static_cast<uint32_t>(std::stoul(text.substr(1), nullptr, 16));
    return {linear_of(rgb >> 16), linear_of(rgb >> 8 & 0xFF), linear_of(rgb & 0xFF)};
}

std::vector<Color> read_colors(const JsonView& array) {
    std::vector<Color> colors;
    for (const JsonView color : array.as_array()) colors.push_back(read_color(color));
    if (colors.empty()) array.fail("must not be empty");
    return colors;
}

// The names of a character's materials and sections, for look-ups and messages.
struct Names {
    explicit Names(const Character& of) : character(of) {
        for (const AssetMaterial& material : character.materials) materials.add(material.name);
        for (const std::string& name : character.section_names) sections.add(name);
    }
    uint32_t material(const std::string& name, const JsonView& where) const {
        const uint32_t found = materials.find(name);
        if (found == kNone) where.fail(materials.unknown(name));
        return found;
    }
    std::vector<uint32_t> of_material(const std::string& name, const JsonView& where) const {
        material(name, where);
        return character.find_sections_of_material(name);
    }
    std::vector<uint32_t> of_section(const std::string& name, const JsonView& where) const {
        if (sections.find(name) == kNone) where.fail(sections.unknown(name));
        return character.find_sections(name);
    }

    const Character& character;
    KnownNames materials{"material"}, sections{"section"};
};

// Sections that all get the same one of some colours, or of some materials.
template <class T>
struct SectionChoice {
    std::vector<uint32_t> sections;
    std::vector<T> alternatives;
};
// Sets of sections, of which only one is shown.
using WearChoice = std::vector<std::vector<uint32_t>>;

const std::initializer_list<std::string_view> kFields{"colors", "materials", "tint", "wear"};

struct Choices {
    Choices(const JsonView& top, const Character& character) {
        const Names names(character);
        top.allow(kFields);
        for (const JsonView color : top.optional_members("colors"))
            colors.push_back({names.of_material(color.key(), color), read_colors(color)});
        for (const JsonView choice : top.optional_members("materials")) {
            std::vector<uint32_t> alternatives;
            for (const JsonView material : choice.as_array())
                alternatives.push_back(names.material(material.as_string(), material));
            if (alternatives.empty()) choice.fail("must not be empty");
            materials.push_back({names.of_material(choice.key(), choice), alternatives});
        }
        for (const JsonView choice : top.optional_members("wear")) {
            WearChoice& of = wear.emplace_back();
            for (const JsonView alternative : choice.as_object()) {
                std::vector<uint32_t>& shown = of.emplace_back();
                for (const JsonView section : alternative.as_array())
                    std::ranges::copy(names.of_section(section.as_string(), section), std::back_inserter(shown));
            }
            if (of.empty()) choice.fail("must not be empty");
        }
        if (const auto tint = top.optional_object("tint")) {
            tint->allow({"materials", "between"});
            for (const JsonView material : tint->required_array("materials"))
                std::ranges::copy(names.of_material(material.as_string(), material), std::back_inserter(tinted));
            tints = read_colors(tint->required("between"));
        }
    }

    std::vector<SectionChoice<Color>> colors;
    std::vector<SectionChoice<uint32_t>> materials;
    std::vector<WearChoice> wear;
    std::vector<uint32_t> tinted;  // sections
    std::vector<Color> tints;
};

template <class T>
const T& one_of(const std::vector<T>& all, Random& random) {
    return all[std::min(static_cast<size_t>(random.unit() * static_cast<double>(all.size())), all.size() - 1)];
}

// The factor that turns the base colour of a section into the wanted one.
Color factor_of(const Character& character, const SectionLook& look, const Color& wanted) {
    const uint32_t material = look.material.value_or(character.sections[look.section].material);
    Color factor = wanted;
    for (size_t i = 0; i < factor.size() && material != kNone; ++i)
        factor[i] = std::min(factor[i] / std::max(character.materials[material].base_color[i], 1e-6f), kMaxFactor);
    return factor;
}

Outfit outfit_of(const Choices& choices, const Character& character, Random& random) {
    Outfit outfit;
    for (uint32_t section = 0; section < character.sections.size(); ++section)
        outfit.sections.push_back({.section = section, .tint = 0});
    const auto set_color = [&](uint32_t section, const Color& wanted) {
        SectionLook& look = outfit.sections[section];
        look.color = factor_of(character, look, wanted);
    };
    for (const auto& [sections, materials] : choices.materials) {
        const uint32_t material = one_of(materials, random);
        for (const uint32_t section : sections) outfit.sections[section].material = material;
    }
    for (const uint32_t section : choices.tinted) {
        outfit.sections[section].tint = 1;
        set_color(section, {1, 1, 1});
    }
    for (const WearChoice& choice : choices.wear) {
        for (const std::vector<uint32_t>& alternative : choice)
            for (const uint32_t section : alternative) outfit.sections[section].is_shown = false;
        for (const uint32_t section : one_of(choice, random)) outfit.sections[section].is_shown = true;
    }
    for (const auto& [sections, colors] : choices.colors) {
        const Color& color = one_of(colors, random);
        for (const uint32_t section : sections) set_color(section, color);
    }
    return outfit;
}

JsonText read_text(const std::string& path, const std::string& file) {
    const std::vector<std::byte> bytes = read_file(path, kJsonTextLimit_bytes, file, "is larger than 4 MiB");
    return JsonText({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, JsonAuthor::kPerson, file);
}

}  // namespace

bool is_looks_file(const std::string& path) {
    bool is_one = false;
    (void)as_result([&] {
        const JsonText text = read_text(path, path);
        is_one = std::ranges::any_of(kFields, [&](std::string_view field) { return text.view().has(field); });
    });
    return is_one;
}

Looks::Looks(const std::string& path, const Character& character) {
    const std::string file = printable(std::filesystem::path(path).filename().string(), 120);
    unwrap(as_result(
        [&] {
            const JsonText text = read_text(path, file);
            try {
                const Choices choices(text.view(), character);
                Random random(1);
                for (uint32_t i = 0; i < kOutfits; ++i) outfits_.push_back(outfit_of(choices, character, random));
                tints_ = choices.tints;
            } catch (const Failure& failure) {
                throw Failure(failure.error.code, text.located(file, failure.error.place), failure.error.message);
            }
        },
        file));
}

std::vector<InstanceLook> Looks::of_instances(const Character& character, std::span<const Affine> world_from_model,
                                              uint64_t seed) const {
    Random random(seed);
    return looks_unlike_neighbours(character, outfits_, world_from_model, [&] {
        InstanceLook look{.outfit = std::min(static_cast<uint32_t>(random.unit() * kOutfits), kOutfits - 1)};
        if (tints_.empty()) return look;
        const Color &a = one_of(tints_, random), &b = one_of(tints_, random);
        const auto between = static_cast<float>(random.unit());
        for (size_t i = 0; i < a.size(); ++i) look.tint[i] = a[i] + (b[i] - a[i]) * between;
        return look;
    });
}

}  // namespace throng::tools
