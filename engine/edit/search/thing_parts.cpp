// Shape decides: prisms below figures, surfaces of revolution below plants.
#include "engine/edit/search/thing_parts.h"

#include <utility>

#include "engine/edit/placement/pedestal_rows.h"
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
    const auto beside = parts_beside(set, bits, nature, up, {});
    for (std::size_t row = 0; row < beside.rows.size(); ++row)
        if (beside.rows[row] != 0) bits[row] = 0;
    for (const auto row : beside.lacking) bits[row] = 1;
    return bits;
}

}  // namespace gse::edit
