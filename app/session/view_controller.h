// The viewport: camera, display settings, comparisons, hidden splats, and the picture that is wanted.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/session/hidden_splats.h"
#include "app/session/preview_host.h"
#include "app/session/state/stage.h"
#include "app/session/state/workspace.h"
#include "app/session/view_pictures.h"

namespace gse::app {

constexpr double MovingSeconds = 0.25;  // after the last movement the picture is refined

class ViewController {
public:
    explicit ViewController(Workspace& workspace)
        : workspace_(workspace), hidden_(workspace), pictures_(workspace) {}

    void run(const ui::ViewCommand& command);
    /// Another document is open: its orbit. Nothing is hidden or compared with.
    void take_document();
    /// The camera is at home unless it was set since the document was opened.
    void settle();
    /// The document changed: what follows its up axis and its rows is made anew.
    void follow_document();
    /// The orbit stands on the scene's up axis, with the camera at home.
    void stand_up();
    /// Draws the picture of a frame, or asks for it.
    void draw(PreviewHost& preview, const Stage& stage);
    /// The document's picture is gone.
    void draw_nothing() { shown_ = {}; }
    void show(ui::ViewportPart& model) const;

    /// The camera moves, or what is drawn does under a hand, or did a moment ago.
    bool moving() const;
    const Camera& camera() const { return camera_; }  // wanted
    Camera shown_camera() const;                      // of the picture on the screen
    void set_camera(const Camera& camera);
    void look_from(const Camera& camera);  // fitted into the viewport
    std::string direction() const;         // that the camera is turned to, for a search
    const std::shared_ptr<const Image>& depth() const { return shown_.depth; }
    const OrbitParameters& orbit() const { return orbit_; }

    const ui::ViewSettings& settings() const { return settings_; }
    void set_settings(const ui::ViewSettings& settings) { settings_ = settings; }
    void tint(bool on) { settings_.tint_labels = on; }
    /// Shows what is made, not where: switches the tint off, once per edit.
    void untint();
    /// The artist's own tint again, where it was switched off for an edit that came to nothing.
    void tint_again();
    /// The tint as it is now is the artist's; returns what was remembered, for keep_tint().
    std::optional<bool> forget_tint() { return std::exchange(tint_before_, std::nullopt); }
    void keep_tint(std::optional<bool> tint) { tint_before_ = tint; }
    /// Comparisons are with the state before an edit again, or with the original.
    void compare_as_usual();

    const HiddenSplats& hidden() const { return hidden_; }
    /// 1 for each hidden row of a set on the screen; rows that a running edit added are seen.
    std::vector<std::uint8_t> hidden_rows(const GaussianSet& set, const Stage& stage) const;
    /// The set as it is seen.
    GaussianSet seen(const GaussianSet& set, const Stage& stage);
    /// The document's splats as they are seen.
    GaussianSet seen_document();
    /// Values of the document's rows on the splats of `set`; new splats have 1. Null where they do not fit.
    RowValues on_screen(const RowValues& values, const GaussianSet& set, const Stage& stage) const;
    /// The other side of comparisons.
    GaussianSet before_on_screen(const Stage& stage) const;
    /// The picture as the last frame wanted it.
    const PictureRequest& wanted() const { return wanted_; }
    /// The splats of the last picture, for thumbnails.
    const GaussianSet& drawn_set() const { return drawn_.set; }

    void to_json(nlohmann::json& json) const;
    /// Throws Error or a JSON exception.
    void from_json(const nlohmann::json& json);

private:
    using Clock = std::chrono::steady_clock;
    struct Comparing {  // with a step that the artist chose
        std::uint64_t revision = 0;
        std::string name;
        GaussianSet set;
        std::shared_ptr<const std::vector<RowId>> ids;
    };
    struct DrawnKey {
        std::uint64_t revision = 0, content = 0;
        int mode = -1, active = -1;
        const edit::EditSnapshot* snapshot = nullptr;
        std::optional<std::size_t> result;
        bool tint = false;
        bool operator==(const DrawnKey&) const = default;
    };
    /// Parts of the picture, kept until something of it changes.
    struct Drawn {
        DrawnKey key;
        GaussianSet set;
        RowValues values;
    };
    template <class C> void on(const C& command);
    const DocumentState& state() const { return workspace_.document.state(); }
    PictureRequest request(const Stage& stage);
    RowValues values_of(const Stage& stage) const;
    void go_home();

    Workspace& workspace_;
    ui::ViewSettings settings_;
    std::optional<bool> tint_before_;  // of the edit whose snapshots are shown
    Camera camera_;
    int width_ = 1, height_ = 1;  // of the viewport
    Clock::time_point last_move_ = Clock::now() - std::chrono::seconds(10);
    OrbitParameters orbit_;  // home: the fitted orbit,
    Bounds home_;            // and what is to be seen from there: what stands on the ground
    Bounds framing_;         // of the whole scene
    Vec3 up_shown_{};        // that the orbit stands on
    ui::Comparison comparison_ = ui::Comparison::None;
    Comparing compared_;
    HiddenSplats hidden_;
    Drawn drawn_;
    PictureState shown_;
    PictureRequest wanted_;  // of the last frame
    ui::SeenColour seen_colour_;
    ViewPictures pictures_;
};

}  // namespace gse::app
