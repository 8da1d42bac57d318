// An application that only remembers what it was asked for, with a small real scene behind its view model.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/scene/document.h"
#include "ui/model/command.h"
#include "ui/model/view_model.h"

namespace gse::test {

/// Situations of the window.
enum class Situation { Nothing, Scene, Located, Editing, ResultWaiting, Failed };

/// An offer to recover work in SCENE.ply.
ui::RecoveryView recovery_of(const std::string& scene);

class FakeApplication final : public ui::Textures {
public:
    explicit FakeApplication(Situation situation);
    ~FakeApplication() override;

    ui::ViewModel& model() { return model_; }
    Document& document() { return *document_; }
    /// Renders the viewport's picture when camera or size changed (only when `pictures`).
    void refresh(bool pictures);

    const Image* picture(std::uint64_t id) const;
    /// Everything asked for, one line each: "locate", "set_label_threshold 0.3", ...
    std::vector<std::string> calls;
    bool asked(const std::string& start) const;
    std::vector<ui::ScreenRegion> regions;
    std::vector<ui::SetOperation> operations;

    ui::TextureId texture(const std::shared_ptr<const Image>& image) override;

    /// Notes a command, and changes the view model where a later frame of the window needs it.
    void run(const ui::Command& command);

private:
    /// Changes of the view model; most commands have none.
    template <class C> void take(const C&) {}
    void take(const ui::command::SaveProject& one);
    void take(const ui::command::LeaveEdit& one);
    void take(const ui::command::LeaveOutView& one);
    void take(const ui::command::SetAttentionThreshold& one);
    void take(const ui::command::SetLabelThreshold& one);
    void take(const ui::command::DeleteLabel& one);
    void take(const ui::command::Select& one);
    void take(const ui::command::AdjustColours& one);
    void take(const ui::command::UsePlacing& one);
    void take(const ui::command::PlaceThing& one);
    void take(const ui::command::PickRows& one);
    void take(const ui::command::DropPicked& one);
    void take(const ui::command::PickColour& one);
    void take(const ui::command::DrawView& one);
    void take(const ui::command::AddView& one);
    void take(const ui::command::SetCamera& one);
    void take(const ui::command::SetViewSettings& one);
    void take(const ui::command::SetViewportSize& one);
    void take(const ui::command::SetComparison& one);
    void take(const ui::command::LookThrough& one);
    void take(const ui::command::SetRequest& one);
    void take(const ui::command::SetModelSettings& one);
    void take(const ui::command::SetExports& one);
    void take(const ui::command::SetUiScale& one);
    void take(const ui::command::SetKeymap& one);

    void make_scene();
    void make_attention();
    void make_work(bool running);
    void make_targets();
    void make_rest();

    ui::ViewModel model_;
    std::vector<ui::LogLine> log_;
    std::unique_ptr<Document> document_;
    struct Renderer;
    std::unique_ptr<Renderer> renderer_;
    std::map<std::uint64_t, std::shared_ptr<const Image>> textures_;
    std::map<const Image*, std::uint64_t> ids_;
    std::shared_ptr<const Image> viewport_picture_;
    Camera rendered_;
    std::uint64_t next_id_ = 100;
};

}  // namespace gse::test
