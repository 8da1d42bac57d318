// Shape decides: prisms below figures, surfaces of revolution below plants.
#include "engine/edit/search/thing_parts.h"

#include <cmath>
#include <utility>

#include "engine/edit/placement/pedestal_rows.h"
#include "engine/edit/placement/region_frame.h"
#include "engine/edit/placement/vessel_rows.h"
#include "engine/language/plan/words/lexicon.h"

namespace gse::edit {
namespace {

/// All that is labelled outside the vessel is the plant or what it grows in.
PartsBeside plant_in(const VesselRows& rows, const std::vector<std::uint8_t>& bits) {
    PartsBeside beside{"plant", rows.vessel, {}};
    for (std::size_t row = 0; row < rows.vessel.size(); ++row) {
        beside.rows[row] = bits[row] != 0 && rows.vessel[row] == 0 ? 1 : 0;
        if (rows.vessel[row] != 0 && bits[row] == 0) beside.lacking.push_back(row);
    }
    return beside;
}

/// Label [N] with all that stands above it, as far again as `Rising` times its height.
std::vector<std::uint8_t> with_rows_above(const GaussianSet& set, std::vector<std::uint8_t> bits,
                                          const Vec3& up) {
    constexpr double Rising = 2, Trim = 0.005, Aside = 0.35;  // of the height, the rows, the width
    const Frame frame = make_frame(up, {});
    std::vector<Vec3> places, labelled;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const auto at = set.position().subspan(row * 3, 3);
        const auto& place = places.emplace_back(frame.to_frame({at[0], at[1], at[2]}));
        if (bits[row] != 0 && std::isfinite(place.x + place.y + place.z)) labelled.push_back(place);
    }
    if (labelled.empty()) return bits;
    Box column = trimmed_box(labelled, Trim);
    const Vec3 size = column.size();
    column.low = column.low - Vec3{Aside * size.x, 0, Aside * size.z};
    column.high = column.high + Vec3{Aside * size.x, Rising * size.y, Aside * size.z};
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (column.has(places[row])) bits[row] = 1;
    return bits;
}

/// A filled vessel is no part of the plant.
PartsBeside vessel_under(VesselRows rows) {
    for (std::size_t row = 0; row < rows.vessel.size(); ++row) rows.vessel[row] |= rows.filling[row];
    return {"vessel", std::move(rows.vessel), {}};
}

}  // namespace

ThingNature nature_of(std::string_view noun) {
    if (language::plan::names_vessel(noun)) return ThingNature::Vessel;
    if (language::plan::names_potted_plant(noun)) return ThingNature::Plant;
    return language::plan::names_figure(noun) ? ThingNature::Figure : ThingNature::Other;
}

PartsBeside parts_beside(const GaussianSet& set, const std::vector<std::uint8_t>& bits, ThingNature nature,
                         const Vec3& up, const Vec3& front) {
    switch (nature) {
        case ThingNature::Figure: return {"pedestal", pedestal_rows(set, bits, up, front), {}};
        case ThingNature::Plant: return vessel_under(vessel_rows(set, bits, up, front));
        case ThingNature::Vessel: return plant_in(vessel_rows(set, bits, up, front), bits);
        case ThingNature::Other: break;
    }
    return {};
}

std::vector<std::uint8_t> without_parts_beside(const GaussianSet& set, std::vector<std::uint8_t> bits,
                                               ThingNature nature, const Vec3& up) {
    if (nature != ThingNature::Plant && nature != ThingNature::Vessel) return bits;
    auto beside = parts_beside(set, bits, nature, up, {});
    if (nature == ThingNature::Vessel && beside.rows.empty()) {  // a box around it leaves the plant out
        const auto rows = vessel_rows(set, with_rows_above(set, bits, up), up, {});
        if (!rows.vessel.empty()) beside = plant_in(rows, bits);
    }
    for (std::size_t row = 0; row < beside.rows.size(); ++row)
        if (beside.rows[row] != 0) bits[row] = 0;
    for (const auto row : beside.lacking) bits[row] = 1;
    return bits;
}

}  // namespace gse::edit
