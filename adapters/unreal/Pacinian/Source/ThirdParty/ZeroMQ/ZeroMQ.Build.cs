using System.IO;
using UnrealBuildTool;

/// libzmq, a shared library with a C interface. ../CMakeLists.txt builds it; see ../README.md.
public class ZeroMQ : ModuleRules
{
    public ZeroMQ(ReadOnlyTargetRules Target) : base(Target)
    {
        Type = ModuleType.External;
        string Platform = Target.Platform.ToString();
        string Binaries = Path.Combine(PluginDirectory, "Binaries", "ThirdParty", "ZeroMQ", Platform);
        PublicSystemIncludePaths.Add(Path.Combine(ModuleDirectory, "Include"));
        if (Target.Platform == UnrealTargetPlatform.Win64)
        {
            PublicAdditionalLibraries.Add(Need(Path.Combine(ModuleDirectory, "Lib", Platform, "libzmq.lib")));
            PublicDelayLoadDLLs.Add("libzmq.dll");
            RuntimeDependencies.Add(Path.Combine(Binaries, "libzmq.dll"));
        }
        else if (Target.Platform == UnrealTargetPlatform.Linux)
        {
            string Library = Need(Path.Combine(Binaries, "libzmq.so.5"));
            PublicAdditionalLibraries.Add(Library);
            RuntimeDependencies.Add(Library);
        }
        else
        {
            throw new BuildException("Pacinian has no libzmq for " + Platform + ": Win64 and Linux only");
        }
    }

    private static string Need(string Name)
    {
        if (File.Exists(Name)) return Name;
        throw new BuildException("Pacinian needs " + Name + ": see Source/ThirdParty/README.md of the plugin");
    }
}
