"""Settings know actions by their names: under another name, the keys that a user chose are lost."""

from collections import Counter

NAMES = """
open export save save_as report save_picture copy_picture quit
open_sample:bottle open_sample:cloth open_sample:cushion open_sample:duck
undo redo reset bake settings take:ORBIT take:BASE take:HANDLE take:REGION take:ERASE take:MOVE
way:BRUSH way:BOX way:LASSO way:POLYGON way:FILL way:PIECE way:LOOP way:SLAB
through larger smaller type_brush choose_by_numbers load_selection save_selection
reshape:GROW reshape:SHRINK reshape:SMOOTH reshape:INVERT
clear:base clear:handle clear:region clear:all lock_part hide_part
reshape:MIRROR_X reshape:MIRROR_Y reshape:MIRROR_Z
remesh
pause add_handle next_handle add_region type_motion put_back compare_methods
pick_pivot type_pivot centre_pivot sweep study press open_study
nudge:(-1,0,0) nudge:(1,0,0) nudge:(0,1,0) nudge:(0,-1,0) nudge:(0,0,1) nudge:(0,0,-1)
along:WORLD along:HANDLE along:VIEW
frame findings look:front look:side look:top look:-front look:-side look:-top edges
smooth shade:sharp shade:flat orthographic up:+X up:-X up:+Y up:-Y up:+Z up:-Z upright
no_measure measure:AREA measure:STRAIN measure:BENDING measure:DISPLACEMENT measure:DISTANCE worst:1 worst:-1
finish:clay finish:pet finish:foil finish:fabric region_picture remove_picture
ghost compare cut ground file_colors textures turntable scheme:Unknown scheme:Light scheme:Dark
shortcuts tour paper copy_diagnostics about panel:readings panel:history panel:plots panel:study
"""


def test_actions_share_no_icon(window):
    images = Counter(entry.image for entry in window.actions_.entries)
    assert [name for name, count in images.items() if count > 1] == []


def test_actions_keep_their_names(window):
    names = [entry.name for entry in window.actions_.entries]
    assert len(names) == len(set(names))
    assert set(names) >= set(NAMES.split())
