using System.IO;
using UnrealBuildTool;

/// msgpack-c, a static library in C. ../CMakeLists.txt builds it; see ../README.md.
public class MsgPack : ModuleRules
{
    public MsgPack(ReadOnlyTargetRules Target) : base(Target)
    {
        Type = ModuleType.External;
        string Platform = Target.Platform.ToString();
        bool bWindows = Target.Platform == UnrealTargetPlatform.Win64;
        string Library = Path.Combine(ModuleDirectory, "Lib", Platform, bWindows ? "msgpackc.lib" : "libmsgpackc.a");
        if (!File.Exists(Library))
        {
            throw new BuildException("Pacinian needs " + Library + ": see Source/ThirdParty/README.md of the plugin");
        }
        PublicSystemIncludePaths.Add(Path.Combine(ModuleDirectory, "Include"));
        PublicAdditionalLibraries.Add(Library);
    }
}
